// What happens at a tentative collision, and with which probabilities.
#pragma once

#include "core/volume/distance_sample.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// What may happen where one medium has a tentative collision under the bound μ̄, for light of weight w.
///
///   weighted:   scattering and null collision in proportion to |w σs| and |w σn|; absorption stays in the weights.
///   analogue:   absorption is a third event, in proportion to |w σa|.
///   decomposed: a share μc / μ̄ of the collisions is real whatever the shader says, μc the least extinction of the
///   leaf;
///               of the others those in proportion to |w (σt − μc)| against |w σn| (Kutz et al. 2017, section 5). So
///               distances are distributed as transmittance falls. Control and residual run in one chain: which of the
///               two a real collision came from is not asked, so the density of the chain stays known.
///
/// All depend on the proportions of the weight alone: roulette and the chances of earlier collisions cancel.
class CollisionOdds {
 public:
  CollisionOdds(const CoefficientSum& medium, float bound, float control, Collisions kind, Color weight,
                const ChannelMixture& channels)
      : sigmaN_(Color(bound) - medium.sigmaT) {
    const float pass = channels.mix(abs(weight * sigmaN_));
    if (kind == Collisions::decomposed) {
      const float certain = std::min(control / bound, 1.0f);
      const float real = channels.mix(abs(weight * (medium.sigmaT - Color(control))));
      const float rest = real + pass > 0 ? (1 - certain) / (real + pass) : 0;
      scatter_ = certain + rest * real;
      pass_ = rest * pass;
      return;
    }
    const float scatter = channels.mix(abs(weight * medium.sigmaS));
    const float absorb =
        kind == Collisions::analogue ? channels.mix(abs(weight * (medium.sigmaT - medium.sigmaS))) : 0.0f;
    if (!(scatter + pass > 0)) return;
    scatter_ = scatter / (scatter + pass + absorb);
    pass_ = absorb > 0 ? pass / (scatter + pass + absorb) : 1 - scatter_;
  }

  /// Neither can be: nothing of the light is left.
  bool areNone() const { return !(scatter_ + pass_ > 0); }
  float scatterProbability() const { return scatter_; }
  float passProbability() const { return pass_; }
  /// μ̄ − σt.
  Color sigmaN() const { return sigmaN_; }

 private:
  Color sigmaN_;
  float scatter_ = 0, pass_ = 0;
};

}  // namespace aerosol::volume
