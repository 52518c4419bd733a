#pragma once
#include "simulator/contacts.h"
#include "tests/support/scenes.h"

namespace grouser::test {

/// The reference vehicle standing at design, its links strewn far away; a test puts one where it may touch.
struct ContactScene {
  System system;
  State state;
  Workspace work;

  ContactScene();
  /// Places link 0 of the left track.
  void put(const Vector3d& position, const Quaterniond& orientation = Quaterniond::Identity());
  /// Discs, guide and sprocket (or the ground) from scratch, without gravity.
  void touch();
  void touch_ground();
  [[nodiscard]] long count(ContactCase which) const { return work.case_count[static_cast<std::size_t>(which)]; }
  [[nodiscard]] const RunningGear& left() const { return system.scenario.vehicle.side(Side::left); }
  /// Moves every body along its velocity.
  void drift(double dt);
  /// Power that all contact forces put into links and chassis [W].
  [[nodiscard]] double power() const;

 private:
  void start();
};

/// Link centre that puts the wheel path `depth` into the rims of a wheel above it, `along` metres ahead of the axle.
[[nodiscard]] Vector3d under_wheel(const ContactScene& scene, const DiscPair& wheel, double along, double depth);
/// Link centre that puts the middle of its pin at (x, z) from the sprocket's axle.
[[nodiscard]] Vector3d with_pin_at(const ContactScene& scene, double x, double z);

}  // namespace grouser::test
