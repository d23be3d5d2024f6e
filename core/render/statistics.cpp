#include "core/render/statistics.h"

namespace aerosol::render {

KernelStatistics& KernelStatistics::operator+=(const KernelStatistics& o) {
  calls += o.calls;
  points += o.points;
  lanes += o.lanes;
  nanoseconds += o.nanoseconds;
  countedLanesRun += o.countedLanesRun;
  countedLanesUsed += o.countedLanesUsed;
  return *this;
}

WorkerStatistics& WorkerStatistics::operator+=(const WorkerStatistics& o) {
  accel += o.accel;
  trackers.points += o.trackers.points;
  trackers.boundViolations += o.trackers.boundViolations;
  if (o.trackers.worstViolation > trackers.worstViolation) {
    trackers.worstViolation = o.trackers.worstViolation;
    trackers.worstMedium = o.trackers.worstMedium;
    trackers.worstExtinction = o.trackers.worstExtinction;
  }
  trackers.stepLimits += o.trackers.stepLimits;
  samples += o.samples;
  pathVertices += o.pathVertices;
  kernelCalls += o.kernelCalls;
  kernelPoints += o.kernelPoints;
  kernelLanes += o.kernelLanes;
  countedLanesRun += o.countedLanesRun;
  countedLanesUsed += o.countedLanesUsed;
  invalidCoefficients += o.invalidCoefficients;
  amplifyingCoefficients += o.amplifyingCoefficients;
  invalidVelocities += o.invalidVelocities;
  invalidClosures += o.invalidClosures;
  raysIntoLights += o.raysIntoLights;
  bodyEntries += o.bodyEntries;
  frameHeapBlocks += o.frameHeapBlocks;
  media += o.media;
  work += o.work;
  if (lightSamples.size() < o.lightSamples.size()) lightSamples.resize(o.lightSamples.size());
  for (std::size_t i = 0; i < o.lightSamples.size(); ++i) lightSamples[i] += o.lightSamples[i];
  if (kernels.size() < o.kernels.size()) kernels.resize(o.kernels.size());
  for (std::size_t i = 0; i < o.kernels.size(); ++i) kernels[i] += o.kernels[i];
  for (std::size_t i = 0; i < phaseCount; ++i) phases[i] += o.phases[i];
  return *this;
}

}  // namespace aerosol::render
