#!/usr/bin/env python3
"""Writes the JSON Schemas beside this file.

A quantity's key is name_unit with any unit of its dimension, so the schemas match keys by pattern. They know the usual
spelling of a compound unit (kN_per_mm, N_m_s_per_rad); the reader takes its factors in any order.
"""
import json
import pathlib

LENGTH, ANGLE, TIME, MASS = "(m|mm|um|cm|km|in|ft)", "(rad|mrad|deg)", "(s|ms|us|min|h)", "(kg|g|t|lb)"
FORCE, VOLT = "(N|daN|kN|MN|kgf|tonf|lbf)", "(V|mV)"
TORQUE = f"({FORCE}_{LENGTH}|J|kJ|MJ)"
AREA, VOLUME = "(m|mm|cm)2", "((m|mm|cm)3|l)"
PRESSURE = f"(Pa|kPa|MPa|GPa|bar|{FORCE}_per_{AREA})"
FREQUENCY = "(Hz|kHz|rpm)"
UNITS = {
    "length": LENGTH, "angle": ANGLE, "time": TIME, "mass": MASS, "force": FORCE, "torque": TORQUE,
    "area": AREA, "volume": VOLUME, "power": "(W|kW)", "pressure": PRESSURE, "frequency": "(Hz|kHz)",
    "speed": f"{LENGTH}_per_{TIME}", "angular speed": f"({ANGLE}_per_{TIME}|rpm)",
    "acceleration": f"{LENGTH}_per_(s2|{TIME}_{TIME})", "inertia": f"{MASS}_{AREA}",
    "stiffness": f"{FORCE}_per_{LENGTH}", "angular stiffness": f"{TORQUE}_per_{ANGLE}",
    "damping": f"{FORCE}_{TIME}_per_{LENGTH}", "angular damping": f"{FORCE}_{LENGTH}_{TIME}_per_{ANGLE}",
    "compliance": f"{LENGTH}_per_{FORCE}", "angular compliance": f"{ANGLE}_per_{TORQUE}",
    "inverse area": f"per_{LENGTH}2", "inverse squared angle": f"per_{ANGLE}2", "inverse temperature": "per_K",
    "temperature": "(K|degC|degF)", "density": f"{MASS}_per_{VOLUME}",
    "area per pressure": f"{AREA}_per_(Pa|kPa|MPa|GPa|bar)", "voltage": VOLT,
    "reading": f"{VOLT}(_per_{VOLT})?",
    "sensitivity": f"({LENGTH}|{ANGLE}|{FORCE}|{TORQUE})(_{VOLT})?_per_{VOLT}",
}

NUMBER, TEXT, BOOLEAN = {"type": "number"}, {"type": "string"}, {"type": "boolean"}
POSITIVE, NOT_NEGATIVE = {"type": "number", "exclusiveMinimum": 0}, {"type": "number", "minimum": 0}
FILE_NAME = {"type": "string", "minLength": 1}
NUMBERS, TEXTS = {"type": "array", "items": NUMBER}, {"type": "array", "items": TEXT}
OPEN_NUMBER = {"type": ["number", "null"]}
OPEN_NUMBERS = {"type": "array", "items": OPEN_NUMBER}
ANYTHING = {}


def whole(least):
    return {"type": "integer", "minimum": least}


def point(size=3):
    return {"type": "array", "items": NUMBER, "minItems": size, "maxItems": size}


def pair_of_open_numbers():
    return {"type": "array", "items": OPEN_NUMBER, "minItems": 2, "maxItems": 2}


def positive_point():
    return {"type": "array", "items": POSITIVE, "minItems": 3, "maxItems": 3}


def list_of(item, least=0):
    return {"type": "array", "items": item, "minItems": least}


def one_of(*words):
    return {"enum": list(words)}


def exists(pattern):
    """Some key matches the pattern."""
    return {"not": {"propertyNames": {"not": {"pattern": pattern}}}}


def record(**members):
    """An object without unknown keys. A member is a schema (plain key), or (dimension, schema) for a quantity; a name with a
    trailing underscore is optional."""
    properties, patterns, required, quantities = {"note": TEXT}, {}, [], []
    for given, member in members.items():
        optional = given.endswith("_")
        name = given.rstrip("_")
        if isinstance(member, tuple):
            dimensions, schema = member
            units = "|".join(UNITS[d] for d in dimensions.split("|"))
            pattern = f"^{name}_({units})$"
            patterns[pattern] = schema
            if not optional:
                quantities.append(exists(pattern))
        else:
            properties[name] = member
            if not optional:
                required.append(name)
    result = {"type": "object", "properties": properties, "additionalProperties": False}
    if patterns:
        result["patternProperties"] = patterns
    if required:
        result["required"] = required
    if quantities:
        result["allOf"] = quantities
    return result


def document(kind, title, **members):
    body = record(format={"const": f"grouser.{kind}/1"}, **members)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"grouser.{kind}/1", "title": title, **body}


PROVENANCE = record(program=TEXT, version=TEXT, command_=TEXT,
                    inputs_=list_of(record(role=TEXT, path=TEXT, sha256={"type": "string", "pattern": "^[0-9a-f]{64}$"})),
                    options_={"type": "object", "additionalProperties": TEXT}, synthetic_=TEXTS)
AXES = ["x", "y", "z", "rx", "ry", "rz"]


# --- rig.json

def sensor(displacements):
    names = {name + "_": (dimension, NUMBERS) for name, dimension in displacements.items()}
    calibration = record(reading=("reading", NUMBERS), **names)
    return record(column=TEXT, sensitivity=("sensitivity", NUMBER), offset_=("reading", NUMBER), linearity_=NUMBERS,
                  record_=calibration)


COLUMNS = record(time_=TEXT, displacement_=TEXT, angle_=TEXT, force_=TEXT, torque_=TEXT, temperature_=TEXT)
CORRECTIONS = list_of(one_of("swap_columns", "reverse_force", "remove_backlash", "remove_creep", "remove_conditioning",
                             "segment_at_jumps"))
MEASURED_TEST = record(name=TEXT, axis=one_of(*AXES), kind=one_of("static", "cyclic"), file=FILE_NAME, columns_=COLUMNS,
                       rate_=("speed|angular speed", POSITIVE), frequency_=("frequency", POSITIVE),
                       amplitude_=("length|angle", POSITIVE), preset_=("length|angle", NUMBER),
                       sample_rate_=("frequency", POSITIVE), discard_cycles_=whole(0),
                       corrections_=CORRECTIONS)


def ramps_to_drive(axes, load, dimension, length, speed):
    protocol = record(ramps_=whole(1), samples_=whole(2), sample_rate_=("frequency", POSITIVE),
                      **{load: (dimension, {"type": "number", "not": {"const": 0}})})
    protocol["not"] = {"allOf": [{"required": ["samples"]}, exists(f"^sample_rate_({UNITS['frequency']})$")]}
    return record(name=TEXT, axis=one_of(*axes), kind={"const": "static"}, protocol=protocol, rate=(speed, POSITIVE),
                  frequency_=("frequency", POSITIVE), amplitude_=(length, POSITIVE), preset_=(length, NUMBER),
                  discard_cycles_=whole(0))


def loops_to_drive(axes, length, speed):
    return record(name=TEXT, axis=one_of(*axes), kind={"const": "cyclic"},
                  protocol=record(cycles_=whole(1), samples_per_cycle_=whole(2)), rate_=(speed, POSITIVE),
                  frequency=("frequency", POSITIVE), amplitude=(length, POSITIVE), preset_=(length, NUMBER),
                  discard_cycles_=whole(0))


RIG_TEST = {"oneOf": [MEASURED_TEST, ramps_to_drive(AXES[:3], "to_force", "force", "length", "speed"),
                      ramps_to_drive(AXES[3:], "to_torque", "torque", "angle", "angular speed"),
                      loops_to_drive(AXES[:3], "length", "speed"), loops_to_drive(AXES[3:], "angle", "angular speed")]}
RIG = document(
    "rig", "Measurement campaign on one specimen",
    specimen=record(name=TEXT, bushings_in_series_=whole(1), geometry_={"type": "object"}),
    rig_compliance_=("compliance", NOT_NEGATIVE), rig_angular_compliance_=("angular compliance", NOT_NEGATIVE),
    moving_mass_=("mass", NOT_NEGATIVE), moving_inertia_=("inertia", NOT_NEGATIVE), corrections_=CORRECTIONS,
    thermal_=record(stiffness_change=("inverse temperature", NUMBER), reference_temperature=("temperature", NUMBER)),
    synthetic_={"type": "object", "properties": {"note": TEXT, "seed": whole(0), "truth": ANYTHING},
                "additionalProperties": False, "required": ["note"]},
    sensors_=record(displacement_=list_of(sensor({"displacement": "length", "angle": "angle"})),
                    force_=sensor({"force": "force", "torque": "torque"}),
                    torque_=sensor({"force": "force", "torque": "torque"})),
    tests=list_of(RIG_TEST, 1))


# --- bushing.json

def spring(displacement, force, slope):
    two = {"type": "array", "items": NUMBER, "minItems": 2}
    turning = {"angle_": (displacement, two), "torque_": (force, two)} if displacement == "angle" else {}
    result = record(displacement_=(displacement, two), force_=(force, two), slope_=(slope, two), **turning)
    units, forces = UNITS[displacement], UNITS[force]
    result["allOf"] = [exists(f"^(displacement|angle)_({units})$"), exists(f"^(force|torque)_({forces})$")]
    return result


def axis_law(displacement, force, stiffness, damping, rate, growth):
    stop = record(stiffness=(stiffness, NOT_NEGATIVE), **{"yield": (displacement, POSITIVE)})
    berg = record(law={"const": "berg"}, force_max=(force, NOT_NEGATIVE), half_displacement=(displacement, POSITIVE))
    return record(
        stiffness=spring(displacement, force, stiffness), friction_=list_of({"oneOf": [stop, berg]}),
        friction_yield_growth_=(growth, NOT_NEGATIVE),
        maxwell_=list_of(record(stiffness=(stiffness, NOT_NEGATIVE), relaxation_time=("time", POSITIVE))),
        viscous_=(damping, NOT_NEGATIVE),
        valid_=record(amplitude=(displacement, NOT_NEGATIVE), frequency_low_=("frequency", NOT_NEGATIVE),
                      frequency_high_=("frequency", NOT_NEGATIVE), rate_=(rate, NOT_NEGATIVE)))


STRAIGHT = axis_law("length", "force", "stiffness", "damping", "speed", "inverse area")
TURNING = axis_law("angle", "torque", "angular stiffness", "angular damping", "angular speed",
                   "inverse squared angle")
BUSHING = document("bushing", "Restoring law of a track bushing on six axes", name=TEXT, synthetic_=BOOLEAN,
                   axes=record(**{axis + "_": TURNING if axis.startswith("r") else STRAIGHT for axis in AXES}),
                   provenance_=PROVENANCE)


# --- fit.json

def measures(turning):
    stiffness, damping = ("N_m_per_rad", "N_m_s_per_rad") if turning else ("N_per_m", "N_s_per_m")
    return {f"effective_stiffness_{stiffness}": OPEN_NUMBER, "dissipated_energy_J": OPEN_NUMBER,
            f"equivalent_damping_{damping}": OPEN_NUMBER, "loss_factor": OPEN_NUMBER,
            f"secant_stiffness_{stiffness}": OPEN_NUMBER, f"storage_stiffness_{stiffness}": OPEN_NUMBER,
            f"loss_stiffness_{stiffness}": OPEN_NUMBER}


def fit_test(turning, prediction):
    """A prediction holds nothing measured, and so no error either."""
    length, force = ("rad", "N_m") if turning else ("m", "N")
    of_cycle, of_curve, of_test = {}, {}, {"prediction": {"const": True}}
    if not prediction:
        of_cycle = {"nrmse": OPEN_NUMBER, **measures(turning)}
        of_curve = {f"force_{force}": OPEN_NUMBERS}
        of_test = {"prediction_": {"const": False}, "r_squared": OPEN_NUMBER, "gain": OPEN_NUMBER,
                   "weight": OPEN_NUMBER, "left_out_nrmse": OPEN_NUMBER, f"force_zero_{force}": OPEN_NUMBER,
                   f"force_drift_{force}": OPEN_NUMBER, **of_cycle}
    cycle = record(index=whole(0), used_=BOOLEAN, fitted=record(**measures(turning)),
                   **{f"amplitude_{length}": OPEN_NUMBER}, **of_cycle)
    curve = record(**{f"displacement_{length}": OPEN_NUMBERS, f"fitted_{force}": OPEN_NUMBERS}, **of_curve)
    axes = [a for a in AXES if a.startswith("r") == turning]
    return record(name=TEXT, axis=one_of(*axes), kind=one_of("static", "cyclic"), samples=whole(0), cycles=whole(0),
                  cycles_used=whole(0), frequency_Hz=OPEN_NUMBER,
                  fitted=record(**measures(turning)), per_cycle=list_of(cycle), curve_=curve,
                  **{f"amplitude_{length}": OPEN_NUMBER}, **of_test)


def fit_axis(turning):
    length, force, stiffness = ("rad", "N_m", "N_m_per_rad") if turning else ("m", "N", "N_per_m")

    def band(quantity):
        return record(**{f"displacement_{length}": OPEN_NUMBERS, quantity: OPEN_NUMBERS}, low_95=OPEN_NUMBERS,
                      high_95=OPEN_NUMBERS)

    parameter = record(name=TEXT, unit=TEXT, value=OPEN_NUMBER, standard_error=OPEN_NUMBER,
                       interval_95=pair_of_open_numbers(),
                       identified_=BOOLEAN)
    solver = record(termination=TEXT, iterations=whole(0), initial_cost=OPEN_NUMBER, final_cost=OPEN_NUMBER,
                    kkt_residual=OPEN_NUMBER, starts=whole(0))
    interval = record(value=OPEN_NUMBER, interval_95=pair_of_open_numbers())
    response = record(frequency_Hz=OPEN_NUMBER, dissipated_energy_J=interval, loss_factor=interval,
                      **{f"amplitude_{length}": OPEN_NUMBER, f"storage_stiffness_{stiffness}": interval,
                         f"loss_stiffness_{stiffness}": interval})
    candidate = record(spring_intervals=whole(0), stops=whole(0), branches=whole(0), strain_dependent_yield_=BOOLEAN,
                       left_out_error=OPEN_NUMBER, chosen_=BOOLEAN)
    clearance = record(**{f"low_{length}": OPEN_NUMBER, f"high_{length}": OPEN_NUMBER}, stiffness_ratio=OPEN_NUMBER)
    hard_stop = record(**{f"at_{length}": OPEN_NUMBER}, stiffness_ratio=OPEN_NUMBER)
    return record(parameters=list_of(parameter), covariance_=list_of(OPEN_NUMBERS), condition_number=OPEN_NUMBER,
                  not_identified_=TEXTS, solver=solver, selection=list_of(candidate), backbone=band(f"force_{force}"),
                  tangent=band(f"stiffness_{stiffness}"), responses=list_of(response), clearance_=clearance,
                  hard_stops=list_of(hard_stop), draws=whole(0),
                  **{f"tangent_window_{length}": OPEN_NUMBER, f"preset_{length}": OPEN_NUMBER})


NOTES = list_of(record(code=TEXT, test_=TEXT, text=TEXT))
FIT_TESTS = list_of({"oneOf": [fit_test(turning, prediction) for turning in (False, True)
                               for prediction in (False, True)]})
FIT = document("fit", "How a bushing is known: tests, parameters, uncertainty", specimen=TEXT, synthetic_=BOOLEAN,
               synthetic_note_=TEXT, calibration_residual=OPEN_NUMBER,
               tests=FIT_TESTS,
               axes=record(**{axis + "_": fit_axis(axis.startswith("r")) for axis in AXES}),
               warnings=NOTES, corrections=NOTES, provenance_=PROVENANCE)

# --- replay.json
REPLAY = document("replay", "Tests of a campaign driven on the bushing of a simulation", specimen=TEXT, bushing=TEXT,
                  tests=FIT_TESTS, warnings=NOTES, corrections=NOTES, provenance_=PROVENANCE)

# --- vehicle.json
RESTITUTION = {"type": "number", "exclusiveMinimum": 0, "maximum": 1}
MASS_OF_PART = {"mass": ("mass", POSITIVE), "inertia": ("inertia", positive_point())}
MASS_OF_BODY = {**MASS_OF_PART, "center_of_mass": ("length", point())}


def contact(stiffness, **more):
    return record(stiffness=(stiffness, POSITIVE), restitution_=RESTITUTION, restitution_speed_=("speed", POSITIVE),
                  friction_=NOT_NEGATIVE, friction_speed_=("speed", POSITIVE),
                  friction_damping_limit_=("damping", POSITIVE), **more)


DISCS = record(**MASS_OF_PART, center=("length", point()), radius=("length", POSITIVE), disc_width=("length", POSITIVE),
               gap=("length", NOT_NEGATIVE), contact=contact("pressure"))
TORSION_BAR = record(kind={"const": "torsion_bar"}, stiffness=("angular stiffness", POSITIVE),
                     free_angle=("angle", NUMBER), damping=("angular damping", NOT_NEGATIVE))
HYDROPNEUMATIC = record(
    kind={"const": "hydropneumatic"}, piston_area=("area", POSITIVE), crank_radius=("length", POSITIVE),
    rod_length=("length", POSITIVE), crank_angle=("angle", NUMBER), gas_volume=("volume", POSITIVE),
    gas_pressure=("pressure", POSITIVE), polytropic_exponent_=POSITIVE,
    gas_charge_temperature_=("temperature", NUMBER), gas_temperature_=("temperature", NUMBER), orifice_area=("area", POSITIVE),
    oil_density_=("density", POSITIVE), blow_off_pressure=("pressure", POSITIVE),
    blow_off_area=("area per pressure", NOT_NEGATIVE), linear_damping=("angular damping", NOT_NEGATIVE))
STATION = record(pivot=("length", point()), arm=record(**MASS_OF_BODY), wheel=DISCS,
                 suspension={"oneOf": [TORSION_BAR, HYDROPNEUMATIC]}, bump_angle_=("angle", POSITIVE),
                 rebound_angle_=("angle", POSITIVE), stop_stiffness_=("angular stiffness", POSITIVE))
IDLER = record(pivot=("length", point()), arm=record(**MASS_OF_BODY), wheel=DISCS,
               tensioner=record(stiffness=("stiffness", POSITIVE), damping=("damping", NOT_NEGATIVE)))
SPROCKET = record(**MASS_OF_PART, center=("length", point()), teeth=whole(5), tip_radius=("length", POSITIVE),
                  base_radius=("length", POSITIVE), flank_angle=("angle", NOT_NEGATIVE),
                  seat_clearance=("length", NOT_NEGATIVE), ring_offset=("length", NOT_NEGATIVE),
                  side_clearance=("length", NOT_NEGATIVE), side_stiffness_=("stiffness", POSITIVE),
                  contact=contact("stiffness"))
GUIDE = record(height=("length", POSITIVE), base_width=("length", POSITIVE), top_width=("length", NOT_NEGATIVE),
               stiffness_=("stiffness", POSITIVE), restitution_=RESTITUTION)
SIX_POINTS = {"type": "array", "items": point(), "minItems": 6, "maxItems": 6}
LINK = record(**MASS_OF_PART, shoe_width=("length", POSITIVE), ground_depth=("length", POSITIVE),
              wheel_path_height=("length", NUMBER), ground_points=("length", SIX_POINTS), guide=GUIDE,
              ground_contact=contact("stiffness", bristle_stiffness_=("stiffness", POSITIVE),
                                     bristle_damping_=("damping", NOT_NEGATIVE)))
TRACK = record(links=whole(10), pitch=("length", POSITIVE), connection=one_of("single_pin", "double_pin"),
               connector_length_=("length", POSITIVE), connector_=record(**MASS_OF_PART, condensed_=BOOLEAN),
               pin_radius=("length", POSITIVE), pre_tension=("force", POSITIVE), pre_torsion_=("angle", NUMBER),
               clearance_=("length", NOT_NEGATIVE), stop_angle_=("angle", POSITIVE),
               stop_stiffness_=("angular stiffness", POSITIVE), bushing_=FILE_NAME, link=LINK)
SIDE = record(track_center_y=("length", NUMBER), sprocket=SPROCKET, idler=IDLER, support_rollers=list_of(DISCS),
              stations=list_of(STATION, 2), track=TRACK)
COLOR = {"type": "string", "pattern": "^#[0-9a-fA-F]{6}$"}
OUTLINE = {"type": "array", "items": point(2), "minItems": 3}
VISUAL = record(parts_=list_of(record(name=TEXT, color=COLOR, outline=("length", OUTLINE), half_width=("length", POSITIVE),
                                      taper_=("length", NOT_NEGATIVE))),
                tubes_=list_of(record(name=TEXT, color=COLOR, **{"from": ("length", point())}, to=("length", point()),
                                      radius=("length", POSITIVE))))


def side_or_mirror(other):
    mirror = {"type": "object", "properties": {"mirror": {"const": other}}, "required": ["mirror"]}
    return {"if": {"required": ["mirror"]}, "then": mirror, "else": SIDE}


VEHICLE = document("vehicle", "A tracked vehicle", name=TEXT, chassis=record(**MASS_OF_BODY),
                   left=side_or_mirror("right"), right=side_or_mirror("left"), visual_=VISUAL, provenance_=PROVENANCE)

# --- scenario.json
DRIVE_TIME = ("time", {**NUMBERS, "minItems": 1})
DRIVE_BY_SPEED = record(time=DRIVE_TIME, speed=("angular speed", {**NUMBERS, "minItems": 1}))
DRIVE_BY_TORQUE = record(time=DRIVE_TIME, torque=("torque", {**NUMBERS, "minItems": 1}),
                         drag_=("angular damping", NOT_NEGATIVE))
DRIVER = record(time=DRIVE_TIME, target_speed=("speed", {**NUMBERS, "minItems": 1}), power=("power", POSITIVE),
                largest_torque=("torque", POSITIVE), brake_torque=("torque", NOT_NEGATIVE),
                response_time_=("time", POSITIVE))
DRIVE = {"anyOf": [DRIVE_BY_SPEED, DRIVE_BY_TORQUE, DRIVER]}
GROUND_SIDE = one_of("both", "left", "right")
OBSTACLE = {"anyOf": [
    record(kind=one_of("half_round"), side_=GROUND_SIDE, position=("length", NUMBER), radius=("length", POSITIVE)),
    record(kind=one_of("trapezoid"), side_=GROUND_SIDE, position=("length", NUMBER), height=("length", POSITIVE),
           base=("length", POSITIVE), top=("length", POSITIVE))]}
TERRAIN = record(
    friction_=NOT_NEGATIVE, slope_=NUMBER, cross_slope_=NUMBER, median_=("length", POSITIVE),
    friction_zones_=list_of(record(side_=GROUND_SIDE, **{"from": ("length", NUMBER)}, to=("length", NUMBER),
                                   friction=NOT_NEGATIVE)),
    profile_=record(file=FILE_NAME, start_=("length", NUMBER)),
    iso_8608_=record(**{"class": one_of(*"ABCDEFGH")}, seed=whole(0), start_=("length", NUMBER),
                     length=("length", POSITIVE)),
    obstacles_=list_of(OBSTACLE))
SCENARIO = document(
    "scenario", "What a vehicle does", name=TEXT, vehicle=FILE_NAME, bushing=FILE_NAME, terrain_=TERRAIN,
    drive=record(left=DRIVE, right=DRIVE), duration=("time", POSITIVE), gravity_=("acceleration", POSITIVE),
    bushing_scale_={"anyOf": [POSITIVE, record(**{axis + "_": POSITIVE for axis in AXES})]},
    output_=record(rate_=("frequency", POSITIVE), probe_rate_=("frequency", POSITIVE),
                   probes_=list_of(record(side=one_of("left", "right"), link=whole(0)))),
    integrator_=record(beta_={"type": "number", "minimum": 1, "maximum": 1.03703703704},
                       velocity_tolerance_=("speed", POSITIVE), displacement_tolerance_=("length", POSITIVE),
                       max_step_=("time", POSITIVE), min_step_=("time", POSITIVE), stability_fraction_=POSITIVE,
                       growth_limit_={"type": "number", "exclusiveMinimum": 1}, fixed_step_=("time", NOT_NEGATIVE)),
    assembly_=record(settle_time_=("time", POSITIVE), step_=("time", POSITIVE)))

# --- camera.json
CAMERA = document("camera", "A camera of the user's own", name=TEXT, mount=one_of("world", "follow", "heading", "chassis"),
                  eye=("length", point()), target=("length", point()), field_of_view_=("angle", POSITIVE),
                  height_=("length", POSITIVE))
CAMERA["oneOf"] = [exists(f"^field_of_view_{ANGLE}$"), exists(f"^height_{LENGTH}$")]

# --- run.json
COUNTS = record(bodies=whole(0), revolute_joints=whole(0), bushings=whole(0), degrees_of_freedom=whole(0),
                prescribed=whole(0))
STEPS = record(accepted=whole(0), rejected=whole(0), force_evaluations=whole(0), min=("time", NUMBER),
               mean=("time", NUMBER), max=("time", NUMBER))
ENERGY = record(input_J=OPEN_NUMBER, dissipated_J=OPEN_NUMBER, residual_J=OPEN_NUMBER, residual_fraction=OPEN_NUMBER)
RUN = document(
    "run", "Summary of a run", name=TEXT, vehicle=TEXT, bushing=TEXT, status=one_of("completed", "stopped", "failed"),
    message=TEXT, simulated_time=("time", NOT_NEGATIVE), wall_time=("time", NOT_NEGATIVE),
    assembly_wall_time=("time", NOT_NEGATIVE), real_time_factor=OPEN_NUMBER, counts=COUNTS, steps=STEPS, energy=ENERGY,
    results={"type": "object", "additionalProperties": OPEN_NUMBER},
    result_notes={"type": "object", "additionalProperties": record(unit=TEXT, meaning=TEXT)},
    checks_=list_of(record(name=TEXT, value=OPEN_NUMBER, unit=TEXT, limit=TEXT, pass_=BOOLEAN)), provenance_=PROVENANCE)

if __name__ == "__main__":
    folder = pathlib.Path(__file__).parent
    for name, schema in {"rig": RIG, "bushing": BUSHING, "fit": FIT, "replay": REPLAY, "vehicle": VEHICLE, "scenario": SCENARIO,
                         "run": RUN, "camera": CAMERA}.items():
        (folder / f"{name}.schema.json").write_text(json.dumps(schema, indent=1) + "\n")
