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
  Lanes3 force = in_all_lanes(Vector3d::Zero()), torque = force;
  void add(const Lanes3& arm, const Lanes3& f) {
    force = force + f;
    torque = torque + cross(arm, f);
  }
};
/// Adds loads in W to the links from `first` on and books their forces to a partner.
void push_links(Workspace& work, int first, const LinkLoads& load_W, Partner partner);
/// Notes which part of them damps or rubs.
void note_losses(Workspace& work, int first, const LinkLoads& lost_W);
/// Forces on a body of the tree, gathered in lanes, in W, with their moments about the base's centre of mass.
struct BodyLoad {
  Lanes3 force = in_all_lanes(Vector3d::Zero()), about_base = force;
};
void push_body(Workspace& work, int body, const BodyLoad& load);
inline void count_case(Workspace& work, ContactCase which, unsigned lanes) {
  work.case_count[static_cast<std::size_t>(which)] += std::popcount(lanes);
}

/// Blocks of a track, as bits, that may hold a link whose centre is within `radius` of `center` (W) seen from the side.
[[nodiscard]] std::uint64_t blocks_near(const CompiledTrack& track, const Workspace& work, const Vector3d& center,
                                        double radius);

/// Calls visit(first, bits) for windows of `width` links or joints in a row that together hold all that are near, each
/// once. near(first) is the mask of eight from `first` on; a window begins at one that is near, and bit k of `bits`
/// says whether the k-th of it is. Neighbours in a track stay neighbours, so one window or two hold all that a wheel
/// meets.
template <int width, typename Near, typename Visit>
void for_windows(const CompiledTrack& track, std::uint64_t blocks, Near near, Visit visit) {
  const int end = track.offset + track.num_links;
  const auto bits_at = [&](int first) { return bits_of(near(first) & LaneMask::first(end - first)); };
  int next = track.offset;  // what stands before it has been visited
  for (; blocks != 0; blocks &= blocks - 1) {
    const int block = track.offset + k_lanes * std::countr_zero(blocks);
    for (int first = std::max(next, block); first < std::min(end, block + k_lanes);) {
      const unsigned bits = bits_at(first);
      if (bits == 0) break;
      first += std::countr_zero(bits);
      if (first >= block + k_lanes) break;  // the next block's own
      visit(first, bits_at(first) & ((1u << width) - 1u));
      next = first += width;
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
