#include "reports/remedies.h"

#include <algorithm>
#include <array>

namespace grouser {
namespace {

struct Entry {
  const char* code;
  const char* title;
  const char* action;
  const char* correction;
};

constexpr std::array<Entry, 25> k_entries{{
    {"drift", "A zero wanders during the test",
     "A straight drift of the force is taken out in the fit and listed with the test. Let the amplifiers warm up and "
     "zero them before each test; where the specimen creeps, ask for the correction.",
     "remove_creep"},
    {"clipped_sensor", "A sensor reached its limit",
     "Repeat the test in a larger range of the sensor: what was cut off cannot be had back.", ""},
    {"spike", "Single samples leap out of the range",
     "Look for a disturbance of the measurement (a loose cable, a switch, a fault of the logger), and take these "
     "samples out of the file: other findings of the same test may come from them.",
     ""},
    {"swapped_columns", "Force and displacement stand in each other’s columns",
     "Name the columns in the rig file as they are, or ask for the correction.", "swap_columns"},
    {"reversed_polarity", "One sensor counts the other way",
     "Change the sign of its sensitivity, or ask for the correction.", "reverse_force"},
    {"wrong_frequency", "The record runs at another frequency than stated",
     "State the frequency that was run, or mend the sample rate of the time column. The fit uses the frequency found.",
     ""},
    {"wrong_amplitude", "The record shows another amplitude than stated",
     "Compare the displacement sensor’s sensitivity with its calibration, or state the amplitude that was run.", ""},
    {"time_gap", "Time jumps within the record", "Ask for the correction, which uses the parts on either side.",
     "segment_at_jumps"},
    {"phase_break", "The motion jumps within a cycle",
     "Ask for the correction, which uses the parts on either side; look for lost blocks of the logger.",
     "segment_at_jumps"},
    {"offset", "A zero lies far from the middle of the loop",
     "Zero the sensor before the test, state its offset in the calibration, or state the preset if it was meant.", ""},
    {"backlash", "There is play between actuator and specimen",
     "Clamp the specimen without play, or ask for the correction.", "remove_backlash"},
    {"preload", "The loop runs about a mean that no preset states",
     "State it as the test’s preset_… if it was meant; the law of the mean position is what is identified.", ""},
    {"conditioning_cycles", "The rubber softens over its first cycles",
     "Expected of filled rubber (Mullins), and within the first cycle of any friction that starts from rest; the "
     "cycles "
     "named are not used. Run more cycles, or ask for the correction to use all of them.",
     "remove_conditioning"},
    {"unsettled_cycles", "The loops had not settled when the test ended", "Run more cycles, or ask for the correction.",
     "remove_conditioning"},
    {"transition_cycles", "Cycles between two amplitudes",
     "Nothing: they belong to neither amplitude and are not used.", ""},
    {"trailing_cycles", "The last cycles run at another amplitude",
     "Nothing: they are not used. Stop the record with the motion.", ""},
    {"thermal_softening", "The specimen warms up and softens",
     "Record the temperature and give thermal in the rig file, pause between tests, or ask for the correction.",
     "remove_conditioning"},
    {"few_samples", "Few samples a cycle",
     "Raise the sample rate: a chord cuts corners off the loop and energy is lost with them.", ""},
    {"tilted_specimen", "The two displacement sensors disagree",
     "Look at the alignment of the specimen and at the sensors’ clamps.", ""},
    {"rate_unknown", "Nothing says how fast the test ran",
     "State frequency_Hz or rate_mm_per_min, or record the time: without them the law knows no rate.", ""},
    {"open_ramp", "A ramp does not come back", "Record the unloading too: it separates friction from stiffness.", ""},
    {"unusable_test", "The test cannot be used", "See the evidence; the test did not enter the fit.", ""},
    {"outside_valid_range", "The motion leaves the range in which the law was identified",
     "Nothing is known of the rubber there; test it there, or do not trust the response.", ""},
    {"no_measurement", "A protocol holds no measurement", "Measure it, or drive it with grouser rig for a prediction.",
     ""},
    {"axis_without_test", "An axis was not tested",
     "Test it, or take its law from another source: a track needs all six.", ""},
}};

}  // namespace

Remedy remedy_of(const std::string& code) {
  const auto entry = std::ranges::find_if(k_entries, [&](const Entry& e) { return code == e.code; });
  if (entry != k_entries.end()) return {entry->title, entry->action, entry->correction};
  std::string words = code;
  std::ranges::replace(words, '_', ' ');
  return {words, "", ""};
}

}  // namespace grouser
