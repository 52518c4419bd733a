#pragma once
#include <algorithm>
#include <bit>
#include <cmath>

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
/// Adds the sum of eight forces on a body of the tree, in W, with their moments about the base's centre of mass.
void push_body(Workspace& work, int body, const Lanes3& force_W, const Lanes3& about_base_W);
/// push_links, and the reverse of the loads on a body of the tree.
void push_apart(const State& state, Workspace& work, int first, const LinkLoads& load_W, int body, Partner partner);

inline void count_case(Workspace& work, ContactCase which, unsigned lanes) {
  work.case_count[static_cast<std::size_t>(which)] += std::popcount(lanes);
}

/// Vectors of eight links in a row from World to the link frames and back; work.rotation from place_links.
[[nodiscard]] inline Lanes3 to_links(const Workspace& work, int first, const Lanes3& v_W) {
  const auto r = [&](int c) { return load(work.rotation[c] + first); };
  return {r(0) * v_W.x + r(3) * v_W.y + r(6) * v_W.z, r(1) * v_W.x + r(4) * v_W.y + r(7) * v_W.z,
          r(2) * v_W.x + r(5) * v_W.y + r(8) * v_W.z};
}
[[nodiscard]] inline Lanes3 to_world(const Workspace& work, int first, const Lanes3& v_L) {
  const auto r = [&](int c) { return load(work.rotation[c] + first); };
  return {r(0) * v_L.x + r(1) * v_L.y + r(2) * v_L.z, r(3) * v_L.x + r(4) * v_L.y + r(5) * v_L.z,
          r(6) * v_L.x + r(7) * v_L.y + r(8) * v_L.z};
}

/// Calls visit(first, near) for windows of eight links in a row that together hold every link of the track whose centre
/// is within `radius` of `center` (W), each once. A window begins at such a link; `near` says which others of it are.
/// Neighbours in a track stay neighbours, so one window or two hold all that a wheel meets. ahead = 1: joints instead,
/// whose link ahead is so near.
template <typename Visit>
void for_links_within(const CompiledTrack& track, const State& state, const Vector3d& center, double radius, int ahead,
                      Visit visit) {
  const Lanes largest = radius * radius;
  const int end = track.offset + track.num_links;
  const auto within = [&](int first) {
    const Lanes3 apart = load3(state.position, first + ahead) - in_all_lanes(center);
    return (dot(apart, apart) <= largest) & LaneMask::first(end - first);
  };
  for (int first = track.offset; first < end; first += k_lanes) {
    LaneMask near = within(first);
    if (const unsigned bits = bits_of(near); bits == 0) {
      continue;
    } else if (const int far = std::countr_zero(bits); far > 0) {
      first += far;
      near = within(first);
    }
    visit(first, near);
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
