#include "simulator/channels.h"

#include <algorithm>
#include <cmath>

#include "simulator/track_watch.h"

namespace grouser {
namespace {

std::string track_path(Side side) { return std::string("/tracks/") + name_of(side); }
std::string probe_path(const ProbeLink& probe) {
  return std::string("/probes/") + name_of(probe.side) + "_" + std::to_string(probe.link);
}

void declare_chassis(const System& system, ChannelTable& table) {
  const std::size_t joints = system.tree.bodies.size();
  table.channels = {{"/time", "s", {}, false},
                    {"/chassis/position", "m", {3}, false},
                    {"/chassis/orientation", "1", {4}, false},
                    {"/chassis/velocity", "m/s", {3}, false},
                    {"/chassis/angular_velocity", "rad/s", {3}, false},
                    {"/chassis/acceleration", "m/s^2", {3}, false},
                    {"/joints/angle", "rad", {joints}, false},
                    {"/joints/rate", "rad/s", {joints}, false},
                    {"/joints/torque", "N m", {joints}, false}};
}

void declare_track(const CompiledTrack& track, ChannelTable& table) {
  const std::string path = track_path(track.side);
  const auto n = static_cast<std::size_t>(track.num_links);
  const auto add = [&](const std::string& name, const char* unit, std::size_t width, bool single) {
    table.channels.push_back({path + "/" + name, unit, {n, width}, single});
  };
  add("link_position", "m", 3, false);
  add("link_orientation", "1", 4, true);
  add("link_velocity", "m/s", 3, true);
  add("link_angular_velocity", "rad/s", 3, true);
  add("bushing_force", "N", 3, true);
  add("bushing_torque", "N m", 3, true);
  add("bushing_deflection", "m, rad", 6, true);
  for (const char* partner : k_partner_names) {
    add(std::string("contact_force/") + partner, "N", 3, true);
    table.channels.back().deflated = true;  // few links touch; all else is noise from the tenth bit on
  }
}

void declare_energy(ChannelTable& table) {
  for (const char* name :
       {"kinetic", "gravity", "bushing", "suspension", "contact", "input", "bushing_loss", "contact_loss",
        "friction_loss", "ground_loss", "suspension_loss", "tensioner_loss", "residual"}) {
    table.channels.push_back({std::string("/energy/") + name, "J", {}, false});
  }
}

ChannelTable declare_probes(const System& system) {
  ChannelTable table{"probes",
                     {{"/probes/time", "s", {}, false},
                      {"/probes/sprocket_torque", "N m", {k_num_sides}, false},
                      {"/probes/upper_run_tension", "N", {k_num_sides}, false}},
                     system.scenario.output.probe_rate};
  for (const ProbeLink& probe : system.scenario.output.probes) {
    const std::string path = probe_path(probe);
    table.channels.push_back({path + "/bushing_force", "N", {3}, false});
    table.channels.push_back({path + "/bushing_torque", "N m", {3}, false});
    table.channels.push_back({path + "/bushing_deflection", "m, rad", {6}, false});
    for (const char* partner : k_partner_names) {
      table.channels.push_back({path + "/contact_force/" + partner, "N", {3}, false});
    }
  }
  return table;
}

/// Puts values into a row, one after the other.
class RowFiller {
 public:
  explicit RowFiller(std::vector<double>& row) : at_(row.data()) {}
  void put(double value) { *at_++ = value; }
  void put(const Vector3d& v) { at_ = std::copy_n(v.data(), 3, at_); }
  void put(const Quaterniond& q) {
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) put(value);
  }
  void put(const Eigen::VectorXd& v) { at_ = std::copy_n(v.data(), v.size(), at_); }
  /// All components of one element after the other.
  void put(const Field& field, int first, int count = 1) {
    const int components = field.components();
    for (int c = 0; c < components; ++c) {
      const double* from = field[c] + first;
      for (int i = 0; i < count; ++i) at_[i * components + c] = from[i];
    }
    at_ += count * components;
  }

 private:
  double* at_;
};

void fill_chassis(const System& system, const Snapshot& at, RowFiller& row) {
  const TreeState& chassis = at.state.chassis;
  const Matrix3d& R_WV = at.work.chassis.base_rotation;
  const Vector3d w = at.work.chassis.base_angular_velocity_W, alpha = R_WV * at.acceleration.chassis.angular;
  const Vector3d to_origin = -(R_WV * system.chassis_center_V);
  row.put(at.state.time);
  row.put(Vector3d(chassis.position + to_origin));
  row.put(chassis.orientation);
  row.put(Vector3d(chassis.velocity + w.cross(to_origin)));
  row.put(w);
  row.put(Vector3d(at.acceleration.chassis.linear + alpha.cross(to_origin) + w.cross(w.cross(to_origin))));
  row.put(chassis.angle);
  row.put(chassis.rate);
  row.put(at.work.chassis.joint_torque);
}

void fill_track(const CompiledTrack& track, const Snapshot& at, RowFiller& row) {
  const auto all = [&](const Field& field) { row.put(field, track.offset, track.num_links); };
  all(at.state.position);
  all(at.state.orientation);
  all(at.state.velocity);
  all(at.work.angular_velocity_W);
  all(at.work.bushing_force);
  all(at.work.bushing_torque);
  all(at.state.history.deflection);
  for (const Field& force : at.work.contact_force_W) all(force);
}

void fill_energy(const EnergyBook& book, RowFiller& row) {
  for (const double value :
       {book.now.kinetic, book.now.gravity, book.now.bushing, book.now.suspension, book.now.contact, book.input,
        book.bushing_loss, book.contact_loss + book.contact_way, book.friction_loss, book.ground_loss,
        book.suspension_loss, book.tensioner_loss, book.residual()}) {
    row.put(value);
  }
}

void fill_probe(const CompiledTrack& track, const ProbeLink& probe, const Snapshot& at, RowFiller& row) {
  const int i = track.offset + probe.link;
  row.put(at.work.bushing_force, i);
  row.put(at.work.bushing_torque, i);
  row.put(at.state.history.deflection, i);
  for (const Field& force : at.work.contact_force_W) row.put(force, i);
}

}  // namespace

ChannelRows::ChannelRows(const System& system) : system_(system) {
  ChannelTable samples{"samples", {}, system.scenario.output.rate};
  declare_chassis(system, samples);
  for (const CompiledTrack& track : system.tracks) declare_track(track, samples);
  declare_energy(samples);
  tables_ = {samples,
             {"steps",
              {{"/steps/time", "s", {}, false},
               {"/steps/size", "s", {}, false},
               {"/steps/error", "1", {}, true},
               {"/steps/limit", "1", {}, true}}},
             declare_probes(system)};
  std::size_t column = 0;
  for (const Channel& channel : samples.channels) {
    const bool orientation = channel.path.ends_with("orientation");
    for (std::size_t i = 0; orientation && i < channel.size(); i += 4) quaternions_.push_back(column + i);
    column += channel.size();
  }
}

std::map<std::string, std::vector<std::string>> ChannelRows::names() const {
  return {{"/joints/names", joint_names(system_)},
          {"/steps/limit_names", {std::begin(k_step_limit_names), std::end(k_step_limit_names)}}};
}

void ChannelRows::fill(RunTable table, const Snapshot& at, std::vector<double>& row) const {
  row.resize(tables_[static_cast<std::size_t>(table)].row_size());
  RowFiller filler(row);
  if (table == RunTable::samples) {
    fill_chassis(system_, at, filler);
    for (const CompiledTrack& track : system_.tracks) fill_track(track, at, filler);
    fill_energy(at.book, filler);
    return;
  }
  filler.put(at.state.time);
  for (const int sprocket : system_.sprocket_body) filler.put(at.work.chassis.joint_torque[sprocket]);
  for (const Side side : {Side::left, Side::right})
    filler.put(upper_run_tension(system_, at.state, at.work, side).mean);
  for (const ProbeLink& probe : system_.scenario.output.probes) {
    fill_probe(system_.tracks[static_cast<std::size_t>(index_of(probe.side))], probe, at, filler);
  }
}

void ChannelRows::blend(RunTable table, std::span<const double> a, std::span<const double> b, double weight,
                        std::vector<double>& row) const {
  row.resize(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) row[i] = (1.0 - weight) * a[i] + weight * b[i];
  if (table != RunTable::samples) return;
  for (const std::size_t q : quaternions_) {
    const double norm =
        std::sqrt(row[q] * row[q] + row[q + 1] * row[q + 1] + row[q + 2] * row[q + 2] + row[q + 3] * row[q + 3]);
    for (std::size_t c = q; c < q + 4; ++c) row[c] /= norm;
  }
}

}  // namespace grouser
