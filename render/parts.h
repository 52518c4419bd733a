#pragma once
#include "model/vehicle.h"
#include "render/mesh.h"

/// Meshes of a vehicle's parts from the numbers that its physics uses. Each stands in its body's frame: origin at the
/// joint (wheels: axle centre; arms: pivot; chassis: the vehicle frame V), axes parallel to V at design.
namespace grouser {

/// One track link in L (origin on the pin line's middle, x to the next joint, z towards the wheels): two grouser bars
/// with rubber pads below, plate, centre guide above, the pin and its bosses at +x; fewer than 300 triangles.
[[nodiscard]] Mesh link_mesh(const Track& track);
/// The same outline in a few dozen triangles, for shadows.
[[nodiscard]] Mesh link_shadow_mesh(const Track& track);

/// Two toothed rings with hub. The tooth gap is the contact geometry: seat fillet, flank, tip circle; gap 0 lies on +x.
[[nodiscard]] Mesh sprocket_mesh(const Sprocket& sprocket, const Track& track);

/// Two discs with the guide's gap between them.
[[nodiscard]] Mesh road_wheel_mesh(const DiscPair& wheel);
[[nodiscard]] Mesh idler_mesh(const DiscPair& wheel);
[[nodiscard]] Mesh roller_mesh(const DiscPair& roller);

/// From the pivot to the wheel's axle at design; `inboard`: +1 or -1, the side of V's y on which the hull lies.
[[nodiscard]] Mesh arm_mesh(const Vector3d& pivot_to_axle, const DiscPair& wheel, double inboard);

/// Hull, turret, gun of the visual section, or a plain hull between the tracks when there is none.
[[nodiscard]] Mesh chassis_mesh(const Vehicle& vehicle);

}  // namespace grouser
