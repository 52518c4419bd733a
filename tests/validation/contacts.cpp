#include "simulator/contacts.h"

#include <cmath>
#include <stdexcept>

#include "simulator/energy_book.h"
#include "tests/support/closed_forms.h"
#include "tests/support/contact_scene.h"
#include "tests/support/ground_link.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

void add_restitution(Chapter& chapter) {
  chapter.section(
      "Restitution of the normal law f = k d (1 + a d')",
      "The rate coefficient a that the program chooses for a restitution e, put back into the exact relation; and "
      "the rebound of a link that comes down flat on its six ground points at 1 m/s, steps of 10 us.");
  const char* exact =
      "closed form: (1 + e) a v = ln[(1 + a v) / (1 - e a v)], exact for any stiffness, exponent and mass";
  // Inverted: five digits of e over a v, by Runge-Kutta of the impact.
  const double table[][2] = {{0.01, 0.99338}, {0.1, 0.93748}, {0.2, 0.88219}, {0.5, 0.74843},
                             {1.0, 0.59362},  {2.0, 0.41072}, {5.0, 0.19698}, {10.0, 0.09998}};
  Worst coefficient;
  for (const auto& [av, e] : table) {
    const Worst here{1.0, rate_coefficient(e, 2.5) * 2.5 / av};
    coefficient = worse(coefficient, here);
  }
  chapter.add({"a v for e from 0.1 to 0.99, over the known one", "", 1.0, coefficient.measured,
               within(2e-3, "five digits of e; e = 0.993 depends on its last one"),
               "numerical impacts of an independent program (Python)"});
  double defect = 0.0;
  for (const double e : {0.2, 0.3, 0.5, 0.835, 0.95, 0.999})
    defect = std::max(defect, std::abs(restitution_defect(e, rate_coefficient(e, 1.0))));
  chapter.add({"left less right side of the relation, e from 0.2 to 0.999", "", 0.0, defect, within(1e-12, "round-off"),
               exact});
  for (const double e : {0.835, 0.5, 0.2}) {
    chapter.add({"rebound of a link, e = " + std::string(e == 0.835 ? "0.835"
                                                         : e == 0.5 ? "0.5"
                                                                    : "0.2"),
                 "m/s", e, rebound_speed(e, 1e-5), within(1e-4, "h² at 10 us, the force's kink at touch-down"), exact});
  }
}

void add_slope(Chapter& chapter) {
  chapter.section("A link on a slope",
                  "One link of 28 kg on its six ground points, friction 0.7, steps of 50 us; the ground is tilted by "
                  "leaning gravity.");
  const double friction = 0.7;
  {
    const System system = slope_system(0.9 * std::atan(friction), friction, 5e-5);
    Stepper stepper(system, standing_link(system), {});
    const double early = mean_place(stepper, 1.0), late = mean_place(stepper, 3.0);
    chapter.add({"creep at 0.9 of the angle of friction, from 1 to 3 s", "mm", 0.0, 1e3 * std::abs(late - early),
                 within(1e-4, "dying vibration of the bristles"), "Coulomb: holds below atan(mu)"});
  }
  for (const double degrees : {40.0, 45.0}) {
    const double slope = degrees * k_pi / 180.0;
    const System system = slope_system(slope, friction, 5e-5);
    Stepper stepper(system, standing_link(system), {});
    const Vector3d early = ground_link_at(stepper, 0.3).velocity;
    const double from = stepper.state().time;
    const Vector3d change = ground_link_at(stepper, 1.3).velocity - early;
    const double time = stepper.state().time - from;
    const double known = 9.81 * (std::sin(slope) - friction * std::cos(slope)), found = change.x() / time;
    const std::string name = degrees == 40.0 ? "40 degrees: " : "45 degrees: ";
    chapter.add({name + "acceleration, mean from 0.3 to 1.3 s", "m/s²", known, found,
                 fraction(0.02, known, "the link nods: its last nod is in or out of the mean"),
                 "Coulomb: g (sin a - mu cos a)"});
    const double normal = change.z() + 9.81 * std::cos(slope) * time;
    const double impulse = 9.81 * std::sin(slope) * time - friction * normal;
    chapter.add({name + "change of speed against the impulse of the normal force", "m/s", impulse, change.x(),
                 fraction(1e-6, impulse, "slip of the bristles within a step"),
                 "Coulomb: friction's impulse is mu times the normal one"});
  }
  {
    const System system = slope_system(k_pi / 4.0, friction, 2.5e-5);
    Stepper stepper(system, standing_link(system), {});
    EnergyBook book = open_book(stepper.work().energy);
    while (stepper.state().time < 0.5) {
      if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the sliding link failed");
      book_step(book, stepper.work().energy, stepper.last_step());
    }
    const double way = get_link(stepper.state(), k_ground_link).position.x() - 20.0;
    const double known = friction * system.tracks[0].mass * 9.81 * std::cos(k_pi / 4.0) * way;
    chapter.add({"45 degrees: energy lost in sliding for 0.5 s", "J", known, book.ground_loss,
                 fraction(0.02, known, "the link nods, and its points are damped"),
                 "closed form: mu m g cos(a) times the way"});
    chapter.add({"45 degrees: residual of the energy book", "J", 0.0, book.residual(),
                 fraction(1e-3, known, "h² at 25 us"), "closed form: energy is kept"});
  }
}

void add_elastic_forces(Chapter& chapter) {
  chapter.section("Forces of a wheel and of the ground at rest",
                  "One link of the reference vehicle pressed straight into a road wheel, or into the ground.");
  ContactScene scene;
  const DiscPair& wheel = scene.left().stations[2].wheel;
  for (const double depth : {1e-3, 2e-3}) {
    scene.put(under_wheel(scene, wheel, 0.0, depth));
    scene.touch();
    const double segment = 4.0 / 3.0 * depth * std::sqrt(2.0 * wheel.radius * depth);
    const double known = 2.0 * wheel.contact.stiffness * segment;
    chapter.add({std::string(depth < 1.5e-3 ? "1 mm" : "2 mm") + " under both discs of a road wheel", "N", known,
                 -scene.work.contact_force_W[0][2][0], fraction(1e-6, known, "round-off of poses"),
                 "closed form: 2 k times the parabola's segment, (4/3) d sqrt(2 R d)"});
  }
  const CompiledTrack& track = scene.system.tracks[0];
  scene.put({20.0, 0.0, track.ground_depth - 1e-3});
  scene.touch_ground();
  const double known = 6.0 * track.ground.stiffness * 1e-3;
  chapter.add({"1 mm under six ground points", "N", known, scene.work.force_W[2][0],
               fraction(1e-9, known, "round-off of poses"), "closed form: 6 k d"});
}

}  // namespace

void add_contacts(Chapter& chapter) {
  add_restitution(chapter);
  add_slope(chapter);
  add_elastic_forces(chapter);
}

}  // namespace grouser::validation
