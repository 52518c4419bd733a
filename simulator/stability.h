#pragma once
#include "simulator/workspace.h"

/// The largest step that is stable for certain, from blocks of one body each.
///
/// Over the root of the mass the motion about a state is u'' + C u' + K u = 0 with symmetric C, K >= 0. Chung-Lee is
/// stable while no eigenvalue of A(h) = (4 beta - 3) h^2 K + 4 h C passes 4: for an eigenvector u of the step,
/// k = u* K u and c = u* C u obey the equation of one degree of freedom, whose limit that is.
/// A is a sum of squares k (g_a u_a - g_b u_b)^2, one an axis of a joint or a direction of a contact, each between two
/// bodies. As (a - b)^2 <= (1 + e) a^2 + (1 + 1 / e) b^2 for any e > 0, A is at most a block diagonal with one block a
/// body. Joints of equal links take e = 1: exact for an endless straight chain. Constraints make eigenvalues smaller
/// only, so a wheel on its arm counts as a body that is free to spin and to go along the arm's way.
/// A link's block in its plane (x, z, pitch) is kept whole. Out of it (y; roll and yaw) sums of what roll and yaw get
/// stand for both, and for a wheel those of its spin and its centre. Left out: what links do in their plane because
/// they are pushed aside by one disc of a pair or one ring of teeth alone, and stresses that turn with a link, 1 % of
/// its stiffness (tension over pitch).
namespace grouser {

/// A direction in the plane of a link: what pushes along (x, z) at a point of it turns it by `pitch` [m] times as much.
struct PlaneDirection {
  Lanes x, z, pitch;
};
/// Rows of a plane block, symmetric: [N/m], [N], [N m] for stiffness.
enum PlaneRow { k_xx, k_zz, k_pitch, k_xz, k_x_pitch, k_z_pitch };
inline constexpr int k_plane_rows = 6;
using PlaneBlock = std::array<Lanes, k_plane_rows>;

/// k g g^T.
[[nodiscard]] inline PlaneBlock along(const PlaneDirection& g, const Lanes& k) {
  const Lanes x = k * g.x, z = k * g.z;
  return {x * g.x, z * g.z, k * g.pitch * g.pitch, x * g.z, x * g.pitch, z * g.pitch};
}
inline void add_block(Field& blocks, int first, const PlaneBlock& block, double times) {
  for (int row = 0; row < k_plane_rows; ++row)
    add_to(blocks[row] + first, times * block[static_cast<std::size_t>(row)]);
}

/// Something out of a link's plane, over its inertia: mobilities [1/kg] of a push aside and of the turning that it
/// brings about x and z.
struct SideMobility {
  Lanes across, turning;
};
/// Adds k times those.
inline void add_side(Field& blocks, int first, const SideMobility& m, const Lanes& k) {
  add_to(blocks[0] + first, m.across * k);
  add_to(blocks[1] + first, m.turning * k);
  add_to(blocks[2] + first, (m.across * m.turning).sqrt() * k);
}

/// 1 + e of a contact on a link, 1 + 1 / e on the wheel of `body` that it meets. The e is the best one for friction of
/// `num_links` equal contacts on a rim of `radius`, each with a link that a push along the rim moves by `link_mobility`
/// [1/kg].
[[nodiscard]] ContactShare contact_share(const Tree& tree, int body, double radius, double link_mobility,
                                         double num_links);

/// Finds the largest stable step of all links, by the tangents of their contacts and joints, and of all wheels, up to
/// `longest` [s], and whose it is. `relaxed`: the rubber has the plain damper of assembly.
void bound_step(const System& system, bool relaxed, double longest, Workspace& work);

/// The largest eigenvalue of eight symmetric 3 x 3 matrices, to round-off (0.2 % too large where the two largest are
/// equal): Newton's method on the characteristic polynomial, from above the largest of its real roots, stays above.
[[nodiscard]] Lanes largest_eigenvalue(const PlaneBlock& a);

}  // namespace grouser
