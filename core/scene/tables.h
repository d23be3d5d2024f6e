// All object types of the scene format with their parameters.
#pragma once

#include <vector>

#include "core/scene/field.h"

namespace aerosol::scene {

const std::vector<TypeTable<Integrator>>& integratorTypes();
const std::vector<TypeTable<Sensor>>& sensorTypes();
const std::vector<TypeTable<Film>>& filmTypes();
const std::vector<TypeTable<ReconstructionFilter>>& filterTypes();
const std::vector<TypeTable<Sampler>>& samplerTypes();
const std::vector<TypeTable<Shape>>& shapeTypes();
const std::vector<TypeTable<Phase>>& phaseTypes();
const std::vector<TypeTable<Emitter>>& emitterTypes();
/// Sampling parameters, of media and volumes.
const std::vector<Field<MediumSampling>>& samplingFields();
/// How fine a displaced surface is, of displacements.
const std::vector<Field<Tessellation>>& tessellationFields();
/// Velocity blur, of volumes.
const std::vector<Field<VelocityBlur>>& velocityFields();
/// What all volumes have beside the parameters of their type and `samplingFields`.
const std::vector<Field<Volume>>& volumeFields();

}  // namespace aerosol::scene
