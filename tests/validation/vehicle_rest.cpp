#include <fmt/format.h>

#include <cmath>

#include "simulator/track_watch.h"
#include "tests/support/plane_vehicle.h"
#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

void add_counts(const System& system, Chapter& chapter) {
  chapter.section("Counts", "The reference vehicle, compiled.");
  const auto add = [&](const char* quantity, double expected, double found) {
    chapter.add({quantity, "", expected, found, within(0.0, "exact"), "the paper's vehicle"});
  };
  add("bodies", 189, system.num_bodies());
  add("revolute joints", 36, system.num_revolute_joints());
  add("bushings", 152, system.num_bushings());
  add("degrees of freedom", 954, system.num_degrees_of_freedom());
}

/// Height of the pin behind link i of a track.
Vector3d pin_behind(const CompiledTrack& track, const State& state, int i) {
  const LinkMotion link = get_link(state, i);
  return link.position - link.orientation * Vector3d(0.5 * track.pitch, 0.0, 0.0);
}

/// A span of the upper run between two wheels: the pins that hang free, from the front.
std::vector<Vector3d> free_pins(const VehicleScene& scene, double rear, double front) {
  const CompiledTrack& track = scene.system.tracks[0];
  std::vector<Vector3d> pins;
  for (int k = 0; k < track.num_links; ++k) {
    const Vector3d pin = pin_behind(track, scene.rest.state, track.offset + k);
    if (pin.z() > 0.9 && pin.x() > rear && pin.x() < front) pins.push_back(pin);
  }
  return pins;
}

/// Largest depth of pins below the chord of the first and the last, and the same of the catenary with horizontal force
/// H through these two (closed form): z = a cosh((x - x0) / a) + c, a = H / w.
Worst sag(const std::vector<Vector3d>& pins, double horizontal_force, double weight_per_length) {
  const double a = horizontal_force / weight_per_length;
  const Vector3d &first = pins.front(), &last = pins.back();
  const double span = std::abs(last.x() - first.x()), rise = last.z() - first.z(), dx = last.x() - first.x();
  // a (cosh(u + s/2a) - cosh(u - s/2a)) = 2 a sinh(u) sinh(s/2a) = rise over the span
  const double sign = dx > 0.0 ? 1.0 : -1.0;
  const double u = std::asinh(sign * rise / (2.0 * a * std::sinh(0.5 * span / a)));
  const double low = std::min(first.x(), last.x());
  const double low_height = dx > 0.0 ? first.z() : last.z(), start = u - 0.5 * span / a;
  Worst found;
  for (const Vector3d& pin : pins) {
    const double chord = first.z() + rise * (pin.x() - first.x()) / dx;
    const double depth = chord - pin.z();
    const double curve = low_height + a * (std::cosh(start + (pin.x() - low) / a) - std::cosh(start));
    if (depth > found.measured) found = {chord - curve, depth};
  }
  return found;
}

void add_sag(const VehicleScene& scene, Chapter& chapter) {
  const Stepper stepper(scene.system, scene.rest.state, scene.rest.knobs);
  const SpanTension tension = upper_run_tension(scene.system, stepper.state(), stepper.work(), Side::left);
  const RunningGear& gear = scene.system.scenario.vehicle.side(Side::left);
  const double weight = gear.track.link.mass * scene.system.scenario.gravity;
  const double half = 0.5 * gear.track.pitch;
  for (std::size_t i = 0; i + 1 < gear.support_rollers.size(); ++i) {
    const double front = gear.support_rollers[i].center.x() - half,
                 rear = gear.support_rollers[i + 1].center.x() + half;
    const std::vector<Vector3d> pins = free_pins(scene, rear, front);
    const double spacing = (pins.front() - pins.back()).norm() / static_cast<double>(pins.size() - 1);
    const Worst depth = sag(pins, tension.mean, weight / spacing);
    chapter.add({fmt::format("upper run at rest: sag of the free pins between support rollers {} and {}", i + 1, i + 2),
                 "mm", 1e3 * depth.reference, 1e3 * depth.measured,
                 fraction(0.05, 1e3 * depth.reference, "rigid links, hinge stiffness"),
                 "closed form, catenary z = (H/w) cosh(w x/H) through the outer free pins, H: tension of the run"});
  }
}

void add_shipped_rest(const VehicleScene& scene, Chapter& chapter) {
  chapter.section("The shipped vehicle at rest",
                  "Reference vehicle and bushing after assembly, with all friction. Ground forces are found from the "
                  "depth of the ground points alone.");
  const Stepper stepper(scene.system, scene.rest.state, scene.rest.knobs);
  const GroundPress press = press_on_ground(scene.system, scene.rest.state);
  const CenterOfMass center = center_of_mass(scene.system, stepper.state(), stepper.work());
  const double weight = scene.system.weight;
  chapter.add({"ground forces, sum", "kN", weight / 1e3, press.force / 1e3,
               fraction(1e-3, weight / 1e3, "left of the settling"), "closed form, weight 51 100 kg · 9.81 m/s²"});
  chapter.add({"ground forces, centre along x less the centre of mass", "mm", 0.0,
               1e3 * (press.moment / press.force - center.position.x()), within(1.0, "left of the settling"),
               "closed form, moments about the centre of mass"});
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const CompiledTrack& track = scene.system.tracks[s];
    const SpanTension tension = upper_run_tension(scene.system, stepper.state(), stepper.work(), side);
    chapter.add({fmt::format("pre-tension of the {} track: mean of the upper run", name_of(side)), "kN",
                 track.pre_tension / 1e3, tension.mean / 1e3,
                 fraction(0.01, track.pre_tension / 1e3, "settling after the tensioner is set"),
                 "20 % of the weight, asked for in the vehicle file"});
    const double leverage =
        track.pre_tension * track.sprocket.pitch_radius * (1.0 - std::cos(k_pi / track.sprocket.teeth));
    chapter.add({fmt::format("torque of the {} sprocket at rest", name_of(side)), "kN m", 0.0,
                 stepper.work().chassis.joint_torque[scene.system.sprocket_body[s]] / 1e3,
                 within(leverage / 1e3, "T R_p (1 - cos(π/10)): a decagon's two runs pull at unequal levers"),
                 "closed form, the same tension on both sides"});
  }
  add_sag(scene, chapter);
}

void add_smooth_rest(Chapter& chapter) {
  const VehicleScene scene = on_ice();
  const Vehicle& vehicle = scene.system.scenario.vehicle;
  const Track& track = vehicle.side(Side::left).track;
  const PlaneVehicle::Rest rest =
      PlaneVehicle(vehicle, 1e8, 9.81).stand(track.pre_tension, vehicle.side(Side::left).idler.tensioner_stiffness);
  chapter.section(
      "Wheel loads without friction",
      "The same vehicle with a bushing of 1e8 N/m and no friction anywhere, so that its rest does not hang "
      "on how it was put down. Reference: Lagrange's equations of hull, twelve arms, two idler arms and two "
      "smooth belts in the plane, written for this table. The tracks lift the end wheels by the pull of "
      "their inclined runs.");
  const char* source = "independent solution (potential energy of hull, arms and a belt of outer tangents)";
  const char* links = "rigid links: force up to half a pitch off the wheel";
  const GroundPress press = press_on_ground(scene.system, scene.rest.state);
  for (std::size_t i = 0; i < rest.ground_loads.size(); ++i) {
    chapter.add({fmt::format("load of wheel {} on the ground", i + 1), "kN", rest.ground_loads[i] / 1e3,
                 press.wheel_forces[i] / 1e3, within(2.5, links), source});
  }
  chapter.add({"rise of the hull from design", "mm", 1e3 * rest.y[1], 1e3 * scene.rest.ride_height_change,
               within(5.0, links), source});
  chapter.add({"pitch of the hull from design, nose down", "mrad", 1e3 * rest.y[2], 1e3 * scene.rest.pitch,
               within(1.5, links), source});
}

}  // namespace

void add_vehicle_rest(Chapter& chapter) {
  const VehicleScene scene = at_rest(shipped_scenario("run_a"));
  add_counts(scene.system, chapter);
  add_shipped_rest(scene, chapter);
  add_smooth_rest(chapter);
}

}  // namespace grouser::validation
