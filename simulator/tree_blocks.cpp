#include <algorithm>

#include "simulator/tree.h"

namespace grouser {
namespace {

/// Children of every body and, last, of the base, those that carry the longest chains first: they then share blocks.
std::vector<std::vector<int>> children_of(const Tree& tree) {
  const std::size_t n = tree.bodies.size();
  std::vector<int> height(n, 1);
  std::vector<std::vector<int>> children(n + 1);
  for (std::size_t i = n; i-- > 0;) {
    const int parent = tree.bodies[i].parent;
    if (parent < 0) continue;
    int& of_parent = height[static_cast<std::size_t>(parent)];
    of_parent = std::max(of_parent, height[i] + 1);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int parent = tree.bodies[i].parent;
    children[parent < 0 ? n : static_cast<std::size_t>(parent)].push_back(static_cast<int>(i));
  }
  for (std::vector<int>& some : children) {
    std::stable_sort(some.begin(), some.end(), [&](int a, int b) {
      return height[static_cast<std::size_t>(a)] > height[static_cast<std::size_t>(b)];
    });
  }
  return children;
}

void set_body(const TreeBody& body, int lane, TreeBlock& block) {
  const Matrix3d& J = body.inertia;
  block.free.set(lane, body.prescribed ? 0.0 : 1.0);
  block.about_y = block.about_y && body.axis == Vector3d::UnitY();
  block.prescribes = block.prescribes || body.prescribed;
  set_lane(lane, body.axis, block.axis);
  set_lane(lane, body.origin, block.origin);
  set_lane(lane, body.center_of_mass, block.center_of_mass);
  block.mass.set(lane, body.mass);
  set_lane(lane, J.diagonal(), block.inertia.diagonal);
  set_lane(lane, {J(1, 2), J(0, 2), J(0, 1)}, block.inertia.beside);
}

/// Adds a block of the bodies given by lane, -1 for none.
void add_block(const Tree& tree, int parent, const std::array<int, k_lanes>& bodies, TreeWorkspace& work) {
  TreeBlock block;
  block.parent = parent;
  block.body.fill(*std::max_element(bodies.begin(), bodies.end()));
  for (int lane = 0; lane < k_lanes; ++lane) {
    const int i = bodies[static_cast<std::size_t>(lane)];
    if (i < 0) continue;
    const TreeBody& body = tree.bodies[static_cast<std::size_t>(i)];
    block.mirror_group = body.mirror_group;
    block.body[static_cast<std::size_t>(lane)] = i;
    set_body(body, lane, block);
    work.place[static_cast<std::size_t>(i)] = {work.blocks.size(), lane};
  }
  if (parent >= 0) work.blocks[static_cast<std::size_t>(parent)].bears = true;
  work.blocks.push_back(block);
}

/// Blocks on the base: eight children of one mirror group in a row.
void add_first_blocks(const Tree& tree, const std::vector<int>& children, TreeWorkspace& work) {
  for (const int group : {0, 1}) {
    std::array<int, k_lanes> bodies;
    std::size_t count = 0;
    const auto add = [&] {
      std::fill(bodies.begin() + static_cast<std::ptrdiff_t>(count), bodies.end(), -1);
      if (count > 0) add_block(tree, -1, bodies, work);
      count = 0;
    };
    for (const int child : children) {
      if (tree.bodies[static_cast<std::size_t>(child)].mirror_group != group) continue;
      bodies[count++] = child;
      if (count == k_lanes) add();
    }
    add();
  }
}

/// Blocks on block `parent`: the first children of its bodies, then the second ones.
void add_blocks_on(const Tree& tree, std::size_t parent, const std::vector<std::vector<int>>& children,
                   TreeWorkspace& work) {
  std::array<int, k_lanes> carriers;
  carriers.fill(-1);
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const auto [block, lane] = work.place[i];
    if (block == parent) carriers[static_cast<std::size_t>(lane)] = static_cast<int>(i);
  }
  for (std::size_t rank = 0;; ++rank) {
    std::array<int, k_lanes> bodies;
    bodies.fill(-1);
    for (std::size_t lane = 0; lane < k_lanes; ++lane) {
      if (carriers[lane] < 0) continue;
      const std::vector<int>& on_carrier = children[static_cast<std::size_t>(carriers[lane])];
      if (rank < on_carrier.size()) bodies[lane] = on_carrier[rank];
    }
    if (*std::max_element(bodies.begin(), bodies.end()) < 0) return;
    add_block(tree, static_cast<int>(parent), bodies, work);
  }
}

}  // namespace

TreeWorkspace make_workspace(const Tree& tree) {
  const std::size_t n = tree.bodies.size(), nowhere = n;
  const std::vector<std::vector<int>> children = children_of(tree);
  TreeWorkspace work;
  work.place.assign(n, {nowhere, 0});
  add_first_blocks(tree, children.back(), work);
  for (std::size_t b = 0; b < work.blocks.size(); ++b) add_blocks_on(tree, b, children, work);
  work.states.resize(work.blocks.size());
  work.joint_torque = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
  return work;
}

}  // namespace grouser
