#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "simulator/assembly.h"
#include "simulator/energy_book.h"
#include "simulator/results.h"

/// A run's memory as a file: everything that a run needs to go on to the very bytes of one that was never stopped.
/// `archive(a, x)` lists the parts of x once, for both directions. The structured bindings name every member, so that
/// one that is added later does not compile until it stands here too. Numbers are stored as this machine holds them.
namespace grouser {

/// What a checkpoint belongs to: it must not be continued by another program, nor on other inputs.
struct CheckpointIdentity {
  std::string program_version;
  /// SHA-256 of the documents as the run understood them (--set applied); empty where there is none.
  std::array<std::string, 6> inputs;
};
inline constexpr std::array<const char*, 6> k_checkpoint_inputs{
    "scenario", "vehicle", "bushing", "left track's bushing", "right track's bushing", "profile of the terrain"};
[[nodiscard]] CheckpointIdentity identity_of(const Scenario& scenario);

/// Collects a checkpoint: writer(a, b, c) appends them.
class CheckpointWriter {
 public:
  template <typename... Parts>
  void operator()(Parts&... parts) {
    (archive(*this, parts), ...);
  }
  void bytes(const void* from, std::size_t size) { payload_.append(static_cast<const char*>(from), size); }
  /// Prefixes a size that the reader is to use.
  std::size_t size(std::size_t now) {
    const auto stored = static_cast<std::uint64_t>(now);
    bytes(&stored, sizeof stored);
    return now;
  }
  /// What the reader is to require: true of all that is written.
  void require(bool /*holds*/, const char* /*expected*/) const {}
  [[nodiscard]] const std::string& payload() const { return payload_; }

 private:
  std::string payload_;
};

/// Hands a checkpoint's parts out again, in the order in which they were written.
class CheckpointReader {
 public:
  /// `file`: where the payload was read from, for messages.
  CheckpointReader(std::string payload, std::filesystem::path file)
      : payload_(std::move(payload)), file_(std::move(file)) {}
  template <typename... Parts>
  void operator()(Parts&... parts) {
    (archive(*this, parts), ...);
  }
  /// Throws InputError behind the end.
  void bytes(void* to, std::size_t size);
  /// The size that was stored. What has a size already belongs to a vehicle and keeps it: InputError where the stored
  /// one differs.
  std::size_t size(std::size_t now);
  /// Throws InputError unless `holds`: a checksum says that the bytes are those that were written, not by whom.
  void require(bool holds, const char* expected) const {
    if (!holds) refuse(expected, "another");
  }
  [[nodiscard]] bool at_end() const { return at_ == payload_.size(); }

 private:
  [[noreturn]] void refuse(const std::string& expected, const std::string& found) const;

  std::string payload_;
  std::filesystem::path file_;
  std::size_t at_ = 0;
};

/// folder/checkpoint, the old one or the new one, never half of it.
void write_checkpoint(const std::filesystem::path& folder, const CheckpointIdentity& identity,
                      const CheckpointWriter& parts);
/// The parts behind the identity. Throws InputError with the reason when there is none, it is damaged, or belongs to
/// another program or other inputs.
[[nodiscard]] CheckpointReader read_checkpoint(const std::filesystem::path& folder, const CheckpointIdentity& identity);

template <typename Archive, typename T>
requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void archive(Archive& a, T& value) { a.bytes(&value, sizeof value); }

/// Classes list their own memory.
template <typename Archive, typename T>
requires requires(T& value, Archive& a) { value.archive(a); }
void archive(Archive& a, T& value) { value.archive(a); }

template <typename Archive>
void archive(Archive& a, std::string& text) {
  text.resize(a.size(text.size()));
  a.bytes(text.data(), text.size());
}

template <typename Archive, typename T, typename Allocator>
requires std::is_arithmetic_v<T>
void archive(Archive& a, std::vector<T, Allocator>& values) {
  values.resize(a.size(values.size()));
  a.bytes(values.data(), values.size() * sizeof(T));
}

template <typename Archive, typename T, std::size_t n>
void archive(Archive& a, std::array<T, n>& parts) {
  for (T& part : parts) archive(a, part);
}

template <typename Archive>
void archive(Archive& a, Vector3d& v) {
  a.bytes(v.data(), 3 * sizeof(double));
}

template <typename Archive>
void archive(Archive& a, Quaterniond& q) {
  a(q.x(), q.y(), q.z(), q.w());
}

template <typename Archive>
void archive(Archive& a, Eigen::VectorXd& v) {
  v.resize(static_cast<Eigen::Index>(a.size(static_cast<std::size_t>(v.size()))));
  a.bytes(v.data(), static_cast<std::size_t>(v.size()) * sizeof(double));
}

template <typename Archive>
void archive(Archive& a, Field& field) {
  a(field.data());
}

template <typename Archive>
void archive(Archive& a, CheckpointIdentity& identity) {
  auto& [program_version, inputs] = identity;
  a(program_version, inputs);
}

template <typename Archive>
void archive(Archive& a, Part& part) {
  auto& [link, body] = part;
  a(link, body);
}

template <typename Archive>
void archive(Archive& a, TreeState& state) {
  auto& [position, orientation, velocity, angular_velocity, angle, rate] = state;
  a(position, orientation, velocity, angular_velocity, angle, rate);
}

template <typename Archive>
void archive(Archive& a, History& history) {
  auto& [deflection, stop, branch, anchor_x, anchor_y, anchor_z, stretch_x, stretch_y, anchored] = history;
  a(deflection, stop, branch, anchor_x, anchor_y, anchor_z, stretch_x, stretch_y, anchored);
}

template <typename Archive>
void archive(Archive& a, State& state) {
  auto& [time, chassis, position, orientation, velocity, angular_velocity, driver, history] = state;
  a(time, chassis, position, orientation, velocity, angular_velocity, driver, history);
}

template <typename Archive>
void archive(Archive& a, Acceleration& acceleration) {
  auto& [chassis, linear, angular, driver] = acceleration;
  auto& [base_linear, base_angular, joint] = chassis;
  a(base_linear, base_angular, joint, linear, angular, driver);
}

template <typename Archive>
void archive(Archive& a, EnergyTerms& terms) {
  auto& [kinetic, gravity, bushing, suspension, contact, input_power, bushing_power, contact_power, friction_power,
         ground_power, suspension_power, tensioner_power, assembly_power, bushing_step_loss, ground_step_loss,
         contact_step_loss] = terms;
  a(kinetic, gravity, bushing, suspension, contact, input_power, bushing_power, contact_power, friction_power,
    ground_power, suspension_power, tensioner_power, assembly_power, bushing_step_loss, ground_step_loss,
    contact_step_loss);
}

template <typename Archive>
void archive(Archive& a, EnergyBook& book) {
  auto& [start, now, input, absolute_input, bushing_loss, contact_loss, friction_loss, ground_loss, suspension_loss,
         tensioner_loss, contact_way] = book;
  a(start, now, input, absolute_input, bushing_loss, contact_loss, friction_loss, ground_loss, suspension_loss,
    tensioner_loss, contact_way);
}

template <typename Archive>
void archive(Archive& a, AssemblyKnobs& knobs) {
  auto& [stiffness_scale, mass_damping, rubber_memory, tensioner_reference] = knobs;
  a(stiffness_scale, mass_damping, rubber_memory, tensioner_reference);
}

template <typename Archive>
void archive(Archive& a, Assembled::SideResult& side) {
  auto& [tension, idler_angle] = side;
  a(tension, idler_angle);
}

template <typename Archive>
void archive(Archive& a, Assembled& assembled) {
  auto& [state, knobs, sides, ride_height_change, pitch, largest_link_speed] = assembled;
  a(state, knobs, sides, ride_height_change, pitch, largest_link_speed);
}

template <typename Archive>
void archive(Archive& a, SlackSpan& slack) {
  auto& [time, given_way] = slack;
  a(time, given_way);
}

template <typename Archive>
void archive(Archive& a, SlackSpell& spell) {
  auto& [begun, last_teeth] = spell;
  a(begun, last_teeth);
}

template <typename Archive>
void archive(Archive& a, RunMeasures::StepSum& sum) {
  auto& [time, count, by_error, by_stability] = sum;
  a(time, count, by_error, by_stability);
}

template <typename Archive>
void archive(Archive& a, LoadMeasure& measure) {
  auto& [largest, square_time] = measure;
  a(largest, square_time);
}

template <typename Archive>
void archive(Archive& a, RubberLoads& loads) {
  auto& [time, torsion, torsion_moment, radial_force, axial_force, largest_deflection, largest_tension, least_tension] =
      loads;
  a(time, torsion, torsion_moment, radial_force, axial_force, largest_deflection, largest_tension, least_tension);
}

template <typename Archive>
void archive(Archive& a, RunMeasures::Mean& mean) {
  auto& [sum, count] = mean;
  a(sum, count);
}

template <typename Archive>
void archive(Archive& a, RunMeasures::Place& place) {
  auto& [x, y, yaw, speed] = place;
  a(x, y, yaw, speed);
}

template <typename Archive>
void archive(Archive& a, RunMeasures& measures) {
  auto& [samples, first, last, rest_ground_force, largest_aside, largest_way, straight_speed, turn_rate, tone_time,
         left_torque, rest_steps, steady_steps, rubber, largest_guide_offset, skipped_teeth, slack, case_total] =
      measures;
  a(samples, first, last, rest_ground_force, largest_aside, largest_way, straight_speed, turn_rate, tone_time,
    left_torque, rest_steps, steady_steps, rubber, largest_guide_offset, skipped_teeth, slack, case_total);
  a.require(tone_time.size() == left_torque.size(), "a torque of the left sprocket at every time of its tone");
}

}  // namespace grouser
