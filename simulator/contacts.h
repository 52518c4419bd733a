#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "simulator/workspace.h"

/// The paper's section 5: discs on link (plate or edge), discs and centre guide, sprocket teeth and pins, ground.
///
/// One normal law everywhere, continuous in penetration and rate (Hunt & Crossley 1975): N = f_el max(0, 1 + a
/// delta_dot). Every elastic force is the gradient of a contact energy, and every power uses the velocity dual to where
/// its force acts, so that the energy book closes.
namespace grouser {

/// Normal force over the elastic one at a penetration rate.
[[nodiscard]] inline Lanes normal_factor(const CompiledContact& law, const Lanes& penetration_rate) {
  return (1.0 + law.rate * penetration_rate).max(0.0);
}

/// Coefficient q [N s/m] of the sliding friction force -q v: mu N / sqrt(v^2 + v_s^2), its slope capped for the
/// explicit step.
[[nodiscard]] inline Lanes sliding_friction(const CompiledContact& law, const Lanes& normal,
                                            const Lanes& speed_squared) {
  return (law.friction * normal / (speed_squared + law.friction_speed * law.friction_speed).sqrt())
      .min(law.friction_slope_limit);
}
/// Its largest value, at rest.
[[nodiscard]] inline Lanes steepest_friction(const CompiledContact& law, const Lanes& normal) {
  return ((law.friction / law.friction_speed) * normal).min(law.friction_slope_limit);
}

inline constexpr double k_least_force = 1e-200;  ///< N; keeps 0 / 0 away from lanes that do not touch

/// Forces on eight links in a row and their moments about the links' centres.
struct LinkLoads {
  Lanes3 force, torque;
  [[nodiscard]] static LinkLoads none() { return {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}; }
  /// A force at `arm` from the centres.
  [[nodiscard]] static LinkLoads at(const Lanes3& arm, const Lanes3& f) { return {f, cross(arm, f)}; }
  void add(const Lanes3& arm, const Lanes3& f) {
    force = force + f;
    torque = torque + cross(arm, f);
  }
};
/// Adds loads in W to the links from `first` on and books their forces to a partner.
void push_links(Workspace& work, int first, const LinkLoads& load_W, Partner partner);
/// Notes which part of them damps or rubs.
void note_losses(Workspace& work, int first, const LinkLoads& lost_W);
/// The link ahead of the last joint is the first one: what was put on its copy behind the last link is its own.
void close_seam(const CompiledTrack& track, Field& field);
inline void count_case(Workspace& work, ContactCase which, unsigned lanes) {
  work.case_count[static_cast<std::size_t>(which)] += std::popcount(lanes);
}

/// Blocks of a track, as bits, that may hold a link whose centre is within `radius` of `center` (W, the same in all
/// lanes) seen from the side. A track of at most 504 links has a bit for each, and one left over.
[[nodiscard]] std::uint64_t blocks_near(const CompiledTrack& track, const Workspace& work, const Lanes3& center,
                                        double radius);

/// Calls visit(first, bits) for windows of `width` links or joints in a row, at most eight, that together hold all that
/// are near, each once. near(first) is the mask of eight from `first` on; a window begins at one that is near, and bit
/// k of `bits` says whether the k-th of it is. Neighbours in a track stay neighbours, so one window or two hold all
/// that a wheel meets.
template <int width, typename Near, typename Visit>
void for_windows(const CompiledTrack& track, std::uint64_t blocks, Near near, Visit visit) {
  constexpr unsigned k_window_bits = (1u << width) - 1u;
  const auto bits_at = [&](int block) {
    if ((blocks >> block & 1u) == 0) return 0u;
    const int first = k_lanes * block;
    return bits_of(near(track.offset + first) & LaneMask::first(track.num_links - first));
  };
  unsigned bits = 0;  // not yet visited, of a block and of the next one
  int block = -1;
  for (std::uint64_t left = blocks; left != 0; left &= left - 1) {
    const int last = block;
    block = std::countr_zero(left);
    bits = (block == last + 1 && last >= 0 ? bits >> k_lanes : bits_at(block)) | bits_at(block + 1) << k_lanes;
    while ((bits & k_all_lanes) != 0) {
      const int lane = std::countr_zero(bits);
      visit(track.offset + k_lanes * block + lane, bits >> lane & k_window_bits);
      bits &= ~(k_window_bits << lane);
    }
  }
}

/// Road wheels, support rollers and idler against wheel path, edges and centre guide.
void disc_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work);

/// Pins against sprocket teeth (top, flanks with root fillet, sides) and base circle.
void sprocket_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work);

/// Ground points against the ground, with bristle friction that truly sticks. `before` is the memory at the last
/// accepted state, h [s] before this one. Writes state.history's anchors.
void ground_contacts(const System& system, const History& before, double h, State& state, Workspace& work);

/// Penetration of pins in the gap frame of a sprocket, and the unit normal on the pin (X, Y).
struct ToothContact {
  Lanes penetration, normal_x, normal_y;
  LaneMask on_tip;  ///< else on fillet or flank
};
[[nodiscard]] ToothContact touch_tooth(const CompiledSprocket& sprocket, const Lanes& x, const Lanes& y);

}  // namespace grouser
