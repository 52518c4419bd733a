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

/// Normal force from the elastic one and the penetration rate.
[[nodiscard]] inline double normal_factor(const CompiledContact& law, double penetration_rate) {
  return std::max(0.0, 1.0 + law.rate * penetration_rate);
}

/// Coefficient q [N s/m] of the sliding friction force -q v: mu N / sqrt(v^2 + v_s^2), its slope capped for the
/// explicit step.
[[nodiscard]] inline double sliding_friction(const CompiledContact& law, double normal, double speed_squared) {
  return std::min(law.friction_slope_limit,
                  law.friction * normal / std::sqrt(speed_squared + law.friction_speed * law.friction_speed));
}

/// One link as the contacts see it.
struct LinkView {
  int index;
  Matrix3d rotation;          ///< link -> W
  Vector3d position;          ///< centre, W [m]
  Vector3d velocity;          ///< W
  Vector3d angular_velocity;  ///< W
  [[nodiscard]] Vector3d velocity_at(const Vector3d& from_center_W) const {
    return velocity + angular_velocity.cross(from_center_W);
  }
};
[[nodiscard]] LinkView view_link(const State& state, const Workspace& work, int i);

/// Forces gathered on one link, moments about its centre, before they are booked once.
struct LinkLoad {
  Vector3d force_W = Vector3d::Zero();
  Vector3d torque_W = Vector3d::Zero();
  void add(const Vector3d& arm_W, const Vector3d& f_W) {
    force_W += f_W;
    torque_W += arm_W.cross(f_W);
  }
};
/// Adds a load to a link's sums and books its force to a partner.
void push_link(Workspace& work, int i, const LinkLoad& load, Partner partner);

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
/// Neighbours in a track stay neighbours, so one window or two hold all that a wheel meets.
template <typename Visit>
void for_links_within(const CompiledTrack& track, const State& state, const Vector3d& center, double radius,
                      Visit visit) {
  const Lanes largest = Lanes::Constant(radius * radius);
  const int end = track.offset + track.num_links;
  const auto within = [&](int first) {
    const Lanes3 apart = load3(state.position, first) - in_all_lanes(center);
    return less_equal(dot(apart, apart), largest) & LaneMask::first(end - first);
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

/// Penetration of a pin in the gap frame of a sprocket, and the unit normal on the pin (X, Y).
struct ToothContact {
  double penetration = 0.0;
  double normal_x = 0.0, normal_y = 0.0;
  ContactCase where = ContactCase::sprocket_top;
};
[[nodiscard]] ToothContact touch_tooth(const CompiledSprocket& sprocket, double x, double y);

}  // namespace grouser
