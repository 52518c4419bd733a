#pragma once
#include "model/vehicle.h"
#include "render/detail.h"
#include "render/mesh.h"

/// Meshes of a vehicle's parts from the numbers that its physics uses. Each stands in its body's frame: origin at the
/// joint (wheels: axle centre; arms: pivot; chassis: the vehicle frame V), axes parallel to V at design.
namespace grouser {

/// One track link in L (origin on the pin line's middle, x to the next joint, z towards the wheels): two grouser bars
/// with rubber pads below, plate, centre guide above, the pin and its bosses at +x (double pin: one at either end).
[[nodiscard]] Mesh link_mesh(const Track& track, const Detail& detail = {});
/// What joins two links with double pins, in the frame of Connector: two end connectors outside of the sprocket's
/// rings, one in the middle, and the bars that the sprocket drives.
[[nodiscard]] Mesh connector_mesh(const Track& track, const Detail& detail = {});
/// The same outline in a few dozen triangles, for shadows.
[[nodiscard]] Mesh link_shadow_mesh(const Track& track);

/// Two toothed rings with hub. The tooth gap is the contact geometry: seat fillet, flank, tip circle; gap 0 lies on +x.
[[nodiscard]] Mesh sprocket_mesh(const Sprocket& sprocket, const Track& track, const Detail& detail = {});

/// Two discs with the guide's gap between them.
[[nodiscard]] Mesh road_wheel_mesh(const DiscPair& wheel, const Detail& detail = {});
[[nodiscard]] Mesh idler_mesh(const DiscPair& wheel, const Detail& detail = {});
[[nodiscard]] Mesh roller_mesh(const DiscPair& roller, const Detail& detail = {});

/// The same discs without their faces, for shadows.
[[nodiscard]] Mesh disc_pair_shadow_mesh(const DiscPair& wheel);

/// From the pivot to the wheel's axle at design; `inboard`: +1 or -1, the side of V's y on which the hull lies.
[[nodiscard]] Mesh arm_mesh(const Vector3d& pivot_to_axle, const DiscPair& wheel, double inboard,
                            const Detail& detail = {});

/// Hull, turret, gun of the visual section, or a plain hull between the tracks when there is none.
[[nodiscard]] Mesh chassis_mesh(const Vehicle& vehicle, const Detail& detail = {});

}  // namespace grouser
