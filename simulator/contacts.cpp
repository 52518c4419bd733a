#include "simulator/contacts.h"

namespace grouser {

void push_links(Workspace& work, int first, const LinkLoads& load_W, Partner partner) {
  add_to3(work.force_W, first, load_W.force);
  add_to3(work.torque_W, first, load_W.torque);
  add_to3(work.contact_force_W[static_cast<std::size_t>(partner)], first, load_W.force);
}

void note_losses(Workspace& work, int first, const LinkLoads& lost_W) {
  add_to3(work.loss_force_W, first, lost_W.force);
  add_to3(work.loss_torque_W, first, lost_W.torque);
}

void close_seam(const CompiledTrack& track, Field& field) {
  const int first = track.offset, copy = track.offset + track.num_links;
  for (int c = 0; c < field.components(); ++c) {
    field[c][first] += field[c][copy];
    field[c][copy] = 0.0;
  }
}

std::uint64_t blocks_near(const CompiledTrack& track, const Workspace& work, const Lanes3& center, double radius) {
  const Field& box = work.box[static_cast<std::size_t>(index_of(track.side))];
  const int num_blocks = (track.num_links + k_lanes - 1) / k_lanes;
  std::uint64_t near = 0;
  for (int block = 0; block < num_blocks; block += k_lanes) {
    const auto side = [&](int c) { return load(box[c] + block); };
    const Lanes x = (side(0) - center.x).max(center.x - side(1)).max(0.0);
    const Lanes z = (side(2) - center.z).max(center.z - side(3)).max(0.0);
    const LaneMask reached = (x * x + z * z <= radius * radius) & LaneMask::first(num_blocks - block);
    near |= static_cast<std::uint64_t>(bits_of(reached)) << block;
  }
  return near;
}

}  // namespace grouser
