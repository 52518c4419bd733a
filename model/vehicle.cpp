#include "model/vehicle.h"

#include <algorithm>
#include <cctype>

#include "model/file_json.h"

namespace grouser {
namespace {

namespace d = dimension;

// No vehicle has a fifth of it; a slip of the keyboard must not ask for all memory, and the search for links near a
// wheel counts 64 blocks of eight (simulator/contacts.h).
constexpr long k_most_links = 500, k_most_teeth = 200;

enum class BodyKind { massive, at_own_origin };

MassProperties read_mass_properties(ObjectReader& r, BodyKind kind = BodyKind::massive) {
  MassProperties body;
  body.mass = r.quantity("mass", d::mass, Range::positive);
  if (kind == BodyKind::massive) body.center_of_mass = r.vector("center_of_mass", d::length);
  body.inertia = r.vector("inertia", d::inertia, Range::positive);
  const double largest = body.inertia.maxCoeff();
  // No distribution of mass has a principal moment above the sum of the other two; a thin plate reaches it.
  if (largest > (1.0 + 1e-9) * (body.inertia.sum() - largest)) {
    r.report(r.key_of("inertia"), "no principal moment above the sum of the other two",
             Json(largest).dump() + " kg m2");
  }
  return body;
}

double read_restitution(ObjectReader& r, double fallback) {
  const double restitution = r.number_or("restitution", fallback);
  if (restitution > 0.0 && restitution <= 1.0) return restitution;
  r.report("restitution", "a number > 0 and <= 1", Json(restitution).dump());
  return fallback;
}

ContactLaw read_contact(ObjectReader& r, const Dimension& stiffness) {
  ContactLaw law;
  law.stiffness = r.quantity("stiffness", stiffness, Range::positive);
  law.restitution = read_restitution(r, law.restitution);
  law.restitution_speed = r.quantity_or("restitution_speed", d::speed, law.restitution_speed, Range::positive);
  law.friction = r.number_or("friction", 0.0, Range::non_negative);
  law.friction_speed = r.quantity_or("friction_speed", d::speed, law.friction_speed, Range::positive);
  law.friction_damping_limit =
      r.quantity_or("friction_damping_limit", d::damping, law.friction_damping_limit, Range::positive);
  return law;
}

DiscPair read_discs(ObjectReader& r) {
  DiscPair discs;
  discs.body = read_mass_properties(r, BodyKind::at_own_origin);
  discs.center = r.vector("center", d::length);
  discs.radius = r.quantity("radius", d::length, Range::positive);
  discs.disc_width = r.quantity("disc_width", d::length, Range::positive);
  discs.gap = r.quantity("gap", d::length, Range::non_negative);
  r.object("contact", [&](ObjectReader& c) { discs.contact = read_contact(c, d::pressure); });
  return discs;
}

TorsionBar read_torsion_bar(ObjectReader& r) {
  TorsionBar bar;
  bar.stiffness = r.quantity("stiffness", d::angular_stiffness, Range::positive);
  bar.free_angle = r.quantity("free_angle", d::angle);
  bar.damping = r.quantity("damping", d::angular_damping, Range::non_negative);
  return bar;
}

Hydropneumatic read_hydropneumatic(ObjectReader& r) {
  Hydropneumatic unit;
  unit.piston_area = r.quantity("piston_area", d::area, Range::positive);
  unit.crank_radius = r.quantity("crank_radius", d::length, Range::positive);
  unit.rod_length = r.quantity("rod_length", d::length, Range::positive);
  unit.crank_angle = r.quantity("crank_angle", d::angle);
  unit.gas_volume = r.quantity("gas_volume", d::volume, Range::positive);
  unit.gas_pressure = r.quantity("gas_pressure", d::pressure, Range::positive);
  unit.polytropic_exponent = r.number_or("polytropic_exponent", unit.polytropic_exponent, Range::positive);
  unit.gas_charge_temperature =
      r.quantity_or("gas_charge_temperature", d::temperature, unit.gas_charge_temperature, Range::positive);
  unit.gas_temperature = r.quantity_or("gas_temperature", d::temperature, unit.gas_charge_temperature, Range::positive);
  unit.orifice_area = r.quantity("orifice_area", d::area, Range::positive);
  unit.oil_density = r.quantity_or("oil_density", d::density, unit.oil_density, Range::positive);
  unit.blow_off_pressure = r.quantity("blow_off_pressure", d::pressure, Range::positive);
  unit.blow_off_area = r.quantity("blow_off_area", d::area_per_pressure, Range::non_negative);
  unit.linear_damping = r.quantity("linear_damping", d::angular_damping, Range::non_negative);
  if (unit.rod_length <= unit.crank_radius) {
    r.report(r.key_of("rod_length"), "a rod longer than the crank", Json(unit.rod_length).dump() + " m");
  }
  return unit;
}

Station read_station(ObjectReader& r) {
  Station station;
  station.pivot = r.vector("pivot", d::length);
  r.object("arm", [&](ObjectReader& arm) { station.arm = read_mass_properties(arm); });
  r.object("wheel", [&](ObjectReader& wheel) { station.wheel = read_discs(wheel); });
  r.object("suspension", [&](ObjectReader& s) {
    station.kind = s.choice<SuspensionKind>(
        "kind", {{"torsion_bar", SuspensionKind::torsion_bar}, {"hydropneumatic", SuspensionKind::hydropneumatic}});
    if (station.kind == SuspensionKind::torsion_bar) {
      station.torsion_bar = read_torsion_bar(s);
    } else {
      station.hydropneumatic = read_hydropneumatic(s);
    }
  });
  station.bump_angle = r.quantity_or("bump_angle", d::angle, station.bump_angle, Range::positive);
  station.rebound_angle = r.quantity_or("rebound_angle", d::angle, station.rebound_angle, Range::positive);
  station.stop_stiffness =
      r.quantity_or("stop_stiffness", d::angular_stiffness, station.stop_stiffness, Range::positive);
  return station;
}

Idler read_idler(ObjectReader& r) {
  Idler idler;
  idler.pivot = r.vector("pivot", d::length);
  r.object("arm", [&](ObjectReader& arm) { idler.arm = read_mass_properties(arm); });
  r.object("wheel", [&](ObjectReader& wheel) { idler.wheel = read_discs(wheel); });
  r.object("tensioner", [&](ObjectReader& t) {
    idler.tensioner_stiffness = t.quantity("stiffness", d::stiffness, Range::positive);
    idler.tensioner_damping = t.quantity("damping", d::damping, Range::non_negative);
  });
  return idler;
}

Sprocket read_sprocket(ObjectReader& r) {
  Sprocket sprocket;
  sprocket.body = read_mass_properties(r, BodyKind::at_own_origin);
  sprocket.center = r.vector("center", d::length);
  sprocket.teeth = r.count("teeth", 5, k_most_teeth);
  sprocket.tip_radius = r.quantity("tip_radius", d::length, Range::positive);
  sprocket.base_radius = r.quantity("base_radius", d::length, Range::positive);
  sprocket.flank_angle = r.quantity("flank_angle", d::angle, Range::non_negative);
  sprocket.seat_clearance = r.quantity("seat_clearance", d::length, Range::non_negative);
  sprocket.ring_offset = r.quantity("ring_offset", d::length, Range::non_negative);
  sprocket.side_clearance = r.quantity("side_clearance", d::length, Range::non_negative);
  sprocket.side_stiffness = r.quantity_or("side_stiffness", d::stiffness, sprocket.side_stiffness, Range::positive);
  r.object("contact", [&](ObjectReader& c) { sprocket.contact = read_contact(c, d::stiffness); });
  if (sprocket.tip_radius <= sprocket.base_radius && r.has_quantity("tip_radius") && r.has_quantity("base_radius")) {
    r.report(r.key_of("tip_radius"), "a radius above base_radius", Json(sprocket.tip_radius).dump() + " m");
  }
  return sprocket;
}

void read_guide(ObjectReader& r, Track& track) {
  track.guide_height = r.quantity("height", d::length, Range::positive);
  track.guide_base_width = r.quantity("base_width", d::length, Range::positive);
  track.guide_top_width = r.quantity("top_width", d::length, Range::non_negative);
  track.guide_stiffness = r.quantity_or("stiffness", d::stiffness, track.guide_stiffness, Range::positive);
  track.guide_restitution = read_restitution(r, track.guide_restitution);
  if (track.guide_top_width > track.guide_base_width) {
    r.report(r.key_of("top_width"), "a width up to base_width", Json(track.guide_top_width).dump() + " m");
  }
}

void read_link(ObjectReader& r, Track& track) {
  track.link = read_mass_properties(r, BodyKind::at_own_origin);
  track.shoe_width = r.quantity("shoe_width", d::length, Range::positive);
  track.ground_depth = r.quantity("ground_depth", d::length, Range::positive);
  track.wheel_path_height = r.quantity("wheel_path_height", d::length);
  track.ground_points = r.vectors("ground_points", d::length);
  constexpr std::size_t points = 6;
  if (r.has_quantity("ground_points") && track.ground_points.size() != points) {
    r.report(r.key_of("ground_points"), "6 points, two pads of three", std::to_string(track.ground_points.size()));
  }
  r.object("guide", [&](ObjectReader& guide) { read_guide(guide, track); });
  r.object("ground_contact", [&](ObjectReader& c) {
    track.ground_contact = read_contact(c, d::stiffness);
    track.ground_bristle_stiffness =
        c.quantity_or("bristle_stiffness", d::stiffness, track.ground_bristle_stiffness, Range::positive);
    track.ground_bristle_damping =
        c.quantity_or("bristle_damping", d::damping, track.ground_bristle_damping, Range::non_negative);
  });
}

/// A connector that is a body must leave something of the link to the shoe.
void read_connector_body(ObjectReader& r, Track& track) {
  const MassProperties body = read_mass_properties(r, BodyKind::at_own_origin);
  track.connector.mass = body.mass;
  track.connector.inertia = body.inertia;
  track.connector.condensed = r.boolean_or("condensed", true);
  const Vector3d shoe = track.link.inertia - lumped_inertia(track.connector, track.pitch);
  if (body.mass < track.link.mass && shoe.minCoeff() > 0.0) return;
  r.report(r.key_of("mass"), "a connector that leaves the link's shoe some mass and inertia",
           Json(body.mass).dump() + " kg, half of it at either end");
}

Track read_track(ObjectReader& r) {
  Track track;
  track.num_links = r.count("links", 10, k_most_links);
  track.pitch = r.quantity("pitch", d::length, Range::positive);
  track.connection = r.choice<Connection>(
      "connection", {{"single_pin", Connection::single_pin}, {"double_pin", Connection::double_pin}});
  if (track.connection == Connection::double_pin) {
    track.connector.length = r.quantity("connector_length", d::length, Range::positive);
    if (track.connector.length >= track.pitch && r.has_quantity("connector_length") && r.has_quantity("pitch")) {
      r.report(r.key_of("connector_length"), "a length below the pitch", Json(track.connector.length).dump() + " m");
    }
  }
  track.pin_radius = r.quantity("pin_radius", d::length, Range::positive);
  track.pre_tension = r.quantity("pre_tension", d::force, Range::positive);
  track.pre_torsion = r.quantity_or("pre_torsion", d::angle, 0.0);
  track.clearance = r.quantity_or("clearance", d::length, 0.0, Range::non_negative);
  if (r.has_quantity("stop_angle")) track.stop_angle = r.quantity("stop_angle", d::angle, Range::positive);
  track.stop_stiffness = r.quantity_or("stop_stiffness", d::angular_stiffness, track.stop_stiffness, Range::positive);
  track.bushing = r.file_name_or_none("bushing");
  r.object("link", [&](ObjectReader& link) { read_link(link, track); });
  if (track.connection == Connection::double_pin) {
    r.optional_object("connector", [&](ObjectReader& connector) { read_connector_body(connector, track); });
  }
  return track;
}

RunningGear read_running_gear(ObjectReader& r) {
  RunningGear gear;
  if (const Json* mirror = r.raw("mirror")) {  // not filled in: there is nothing to take it from
    r.report("mirror", "the name of the other side, and that side given in full", shown(*mirror));
    return gear;
  }
  gear.track_center_y = r.quantity("track_center_y", d::length);
  r.object("sprocket", [&](ObjectReader& s) { gear.sprocket = read_sprocket(s); });
  r.object("idler", [&](ObjectReader& i) { gear.idler = read_idler(i); });
  r.each("support_rollers", 0, [&](ObjectReader& s) { gear.support_rollers.push_back(read_discs(s)); });
  r.each("stations", 2, [&](ObjectReader& s) { gear.stations.push_back(read_station(s)); });
  r.object("track", [&](ObjectReader& t) { gear.track = read_track(t); });
  const auto rearwards = [](const Station& a, const Station& b) { return a.wheel.center.x() > b.wheel.center.x(); };
  if (!std::is_sorted(gear.stations.begin(), gear.stations.end(), rearwards)) {
    r.report("stations", "stations from front to rear", "a station ahead of the one before it");
  }
  return gear;
}

std::string read_color(ObjectReader& r) {
  const std::string color = r.text("color");
  const bool right = color.size() == 7 && color[0] == '#' &&
                     std::all_of(color.begin() + 1, color.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (!right && r.has("color")) r.report("color", "a colour as \"#6b7f4a\"", Json(color).dump());
  return color;
}

void read_visual(ObjectReader& r, Vehicle& vehicle) {
  r.each_optional("parts", [&](ObjectReader& p) {
    VisualPart& part = vehicle.visual_parts.emplace_back();
    part.name = p.text("name");
    part.color = read_color(p);
    part.outline = p.vectors("outline", d::length, 2);
    part.half_width = p.quantity("half_width", d::length, Range::positive);
    part.taper = p.quantity_or("taper", d::length, 0.0, Range::non_negative);
    if (part.outline.size() < 3 && p.has_quantity("outline")) {
      p.report(p.key_of("outline"), "at least 3 points", std::to_string(part.outline.size()));
    }
  });
  r.each_optional("tubes", [&](ObjectReader& t) {
    VisualTube& tube = vehicle.visual_tubes.emplace_back();
    tube.name = t.text("name");
    tube.color = read_color(t);
    tube.from = t.vector("from", d::length);
    tube.to = t.vector("to", d::length);
    tube.radius = t.quantity("radius", d::length, Range::positive);
  });
}

/// Turns the y of every position of one side over: `center_*`, `pivot_*`, `center_of_mass_*` (relative),
/// `track_center_y_*`.
void reverse_y(Json& value) {
  if (value.is_array()) {
    for (Json& item : value) reverse_y(item);
  }
  if (!value.is_object()) return;
  for (auto item = value.begin(); item != value.end(); ++item) {
    const auto quantity = split_name_and_unit(item.key());
    const std::string name = quantity ? quantity->name : "";
    Json& inner = item.value();
    if (name == "center" || name == "pivot" || name == "center_of_mass") {
      if (inner.is_array() && inner.size() == 3 && inner[1].is_number()) inner[1] = 0.0 - inner[1].get<double>();
    } else if (name == "track_center_y" && inner.is_number()) {
      inner = 0.0 - inner.get<double>();
    } else {
      reverse_y(inner);
    }
  }
}

}  // namespace

std::string expand_mirrored_side(Json& vehicle) {
  if (!vehicle.is_object()) return {};
  for (const auto& [side, other] : {std::pair("left", "right"), std::pair("right", "left")}) {
    const auto given = vehicle.find(side), source = vehicle.find(other);
    if (given == vehicle.end() || source == vehicle.end() || !given->is_object() || !source->is_object()) continue;
    if (!given->contains("mirror") || (*given)["mirror"] != other || source->contains("mirror")) continue;
    Json mirrored = *source, on_top = *given;
    on_top.erase("mirror");
    reverse_y(mirrored);
    mirrored.merge_patch(on_top);
    *given = mirrored;
    return side;
  }
  return {};
}

void forget_mirrored_findings(const std::string& mirrored_side, Findings& findings) {
  if (mirrored_side.empty()) return;
  const std::string given = mirrored_side == "right" ? "/left" : "/right", filled = "/" + mirrored_side;
  const std::vector<InputFinding> all = findings.list();
  findings.remove_if([&](const InputFinding& finding) {
    if (finding.place.rfind(filled, 0) != 0) return false;
    const std::string twin = given + finding.place.substr(filled.size());
    return std::any_of(all.begin(), all.end(), [&](const InputFinding& other) {
      return other.place == twin && other.expected == finding.expected && other.found == finding.found;
    });
  });
}

Vehicle read_vehicle(ObjectReader& reader) {
  Vehicle vehicle;
  vehicle.name = reader.text("name");
  reader.object("chassis", [&](ObjectReader& r) { vehicle.chassis = read_mass_properties(r); });
  for (const Side side : {Side::left, Side::right}) {
    reader.object(name_of(side), [&](ObjectReader& r) { vehicle.side(side) = read_running_gear(r); });
  }
  reader.optional_object("visual", [&](ObjectReader& r) { read_visual(r, vehicle); });
  vehicle.provenance = read_provenance(reader);
  return vehicle;
}

Vehicle read_vehicle(const std::filesystem::path& file) {
  Findings findings(file.string());
  const std::string bytes = read_whole(file);
  Json document = parse_json(bytes, findings);
  const std::string mirrored = expand_mirrored_side(document);
  Vehicle vehicle;
  if (findings.empty() || !document.is_null()) {
    read_document(document, k_vehicle_format, findings, [&](ObjectReader& reader) { vehicle = read_vehicle(reader); });
    forget_mirrored_findings(mirrored, findings);
  }
  findings.throw_if_any();
  vehicle.provenance.inputs.push_back(provenance_input("vehicle", file.string(), bytes));
  return vehicle;
}

}  // namespace grouser
