#include "tests/support/tree_references.h"

#include <cmath>

namespace grouser::test {
namespace {

const Vector3d k_gravity_y(0.0, -9.81, 0.0), k_gravity_z(0.0, 0.0, -9.81);

/// Unit bodies along x, hinged at z.
Tree unit_chain(int length) {
  Tree tree;
  tree.base_fixed = true;
  for (int i = 0; i < length; ++i) {
    TreeBody body;
    body.parent = i - 1;
    body.axis = Vector3d::UnitZ();
    body.origin = (i == 0 ? 0.0 : 1.0) * Vector3d::UnitX();
    body.mass = 1.0;
    body.center_of_mass = Vector3d::UnitX();
    body.inertia = Matrix3d::Identity();
    tree.bodies.push_back(body);
  }
  return tree;
}

TreeBody rod(int parent, const Vector3d& axis, double length, double mass, const Vector3d& inertia) {
  TreeBody body;
  body.parent = parent;
  body.axis = axis;
  body.origin = parent < 0 ? Vector3d::Zero() : Vector3d(length, 0.0, 0.0);
  body.mass = mass;
  body.center_of_mass = Vector3d(0.5 * length, 0.0, 0.0);
  body.inertia = inertia.asDiagonal();
  return body;
}

Tree spring_chain() {
  Tree tree;
  tree.base_fixed = true;
  constexpr double length = 0.15, mass = 15.0;
  const double across = mass * length * length / 12.0;
  for (int i = 0; i < 10; ++i)
    tree.bodies.push_back(rod(i - 1, Vector3d::UnitY(), length, mass, {0.01, across, across}));
  return tree;
}

/// Five bars of 2 m and 20 kg on hinges whose frames are turned from bar to bar, as EXUDYN's test builds them.
Tree tilted_chain() {
  Tree tree;
  tree.base_fixed = true;
  constexpr double length = 2.0, width = 0.1, mass = 1000.0 * length * width * width;
  const Vector3d inertia =
      mass / 12.0 * Vector3d(2.0 * width * width, length * length + width * width, length * length + width * width);
  Matrix3d to_base = Matrix3d::Identity();  // of the frame whose z is the hinge, all hinges at zero
  for (int i = 0; i < 5; ++i) {
    TreeBody body;
    body.parent = i - 1;
    body.origin = i == 0 ? Vector3d::Zero() : Vector3d(length * to_base.col(0));
    const Eigen::AngleAxisd about_x(0.5 * k_pi, Vector3d::UnitX()), about_y(0.25 * k_pi, Vector3d::UnitY());
    if (i % 3 >= 1) {
      to_base = to_base * (about_x * about_y).toRotationMatrix();
    } else if (i % 2 != 0) {
      to_base = to_base * about_y.toRotationMatrix();
    }
    body.axis = to_base.col(2);
    body.mass = mass;
    body.center_of_mass = 0.5 * length * to_base.col(0);
    body.inertia = to_base * inertia.asDiagonal() * to_base.transpose();
    tree.bodies.push_back(body);
  }
  return tree;
}

HingedRod hinged_rod(const char* name, TorqueLaw torque, const Vector3d& axis, const Vector3d& hinge,
                     std::vector<HingedRod::At> known) {
  HingedRod made;
  made.name = name;
  made.tree.base_fixed = true;
  TreeBody body;
  body.axis = axis;
  body.mass = 1.0;
  body.center_of_mass = Vector3d(2.0, 0.0, 0.0);
  body.inertia = Vector3d(0.04, 0.1, 0.1).asDiagonal();
  made.tree.bodies = {body};
  made.start = make_state(made.tree);
  made.start.position = hinge;
  made.torque = std::move(torque);
  made.known = std::move(known);
  return made;
}

}  // namespace

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  return Eigen::VectorXd::Map(values.begin(), static_cast<Eigen::Index>(values.size()));
}

Eigen::VectorXd no_torque(const TreeState& state) { return Eigen::VectorXd::Zero(state.angle.size()); }

std::vector<FallReference> published_falls() {
  Tree across = unit_chain(2);
  across.bodies[1].axis = Vector3d::UnitY();
  across.bodies[1].center_of_mass = Vector3d::UnitY();
  return {{"one body", unit_chain(1), vector_of({-4.905})},
          {"two bodies in a row", unit_chain(2), vector_of({-5.886, 3.924})},
          {"three bodies in a row", unit_chain(3), vector_of({-6.03692307692308, 3.77307692307692, 1.50923076923077})},
          {"two bodies on crossed hinges", across, vector_of({-3.924, 0.0})},
          {"five branching bodies", five_body_tree(),
           vector_of({-1.6031906614786, -0.534396887159533, 4.1034046692607, 0.267198443579767, 5.30579766536965})}};
}

GenericState::GenericState() : state(make_state(tree)) {
  state.angle = vector_of({0.3, -0.4, 0.5, 0.6, -0.7});
  state.rate = vector_of({1.1, -1.2, 1.3, -0.1, 0.2});
  torque = vector_of({0.5, -0.3, 0.2, 0.1, -0.4});
  acceleration =
      vector_of({-0.896520835556976, -2.53969241941477, 1.76448968591703, -0.865767038176765, 2.42569523672112});
  mass_matrix_column =
      vector_of({9.97973659158745, -0.420784015928471, -0.285442975776752, -0.0910376309556479, -0.564987518984467});
  kinetic = 9.80814271677356;
  potential = 31.0333913374693;
}

Eigen::VectorXd inverse_dynamics(Tree tree, const TreeState& state, const Vector3d& gravity,
                                 const Eigen::VectorXd& acceleration) {
  for (TreeBody& body : tree.bodies) body.prescribed = true;
  TreeWorkspace work = make_workspace(tree);
  TreeAcceleration found;
  found.joint = Eigen::VectorXd::Zero(acceleration.size());
  place_tree(tree, state, gravity, work);
  tree_accelerations(tree, state, std::vector<double>(acceleration.begin(), acceleration.end()), work, found);
  return work.joint_torque;
}

MotionReference five_body_fall() {
  MotionReference r;
  r.name = "five branching bodies";
  r.source = "dense mass matrix and DOP853 (numpy, scipy), whose accelerations are RBDL's";
  r.tree = five_body_tree();
  r.start = make_state(r.tree);
  r.gravity = k_gravity_y;
  r.tolerance = 1e-9;
  r.reason = "reference integrator at 0.25 ms";
  r.known = {
      {0.5,
       vector_of({-0.205199113019118, -0.0103139825163326, 0.503572075753378, 0.0998314513278175, 0.648153739084193}),
       vector_of({-0.812065013091876, 0.188047804096764, 1.95568247668095, 0.660391708277254, 2.46753244538466})},
      {1.0, vector_of({-0.704526093115016, 0.464225607554907, 1.68792635704757, 0.812067405232771, 1.97273353413807}),
       vector_of({-1.20460299101987, 1.5613411286373, 2.21749261649444, 1.71380176532364, 2.07028296332169})},
      {2.0, vector_of({-2.99262949289381, 1.54526300158919, 1.32379329841063, 2.36366082393606, 0.769140993909234}),
       vector_of({-2.25805035941988, 0.674658231181519, -2.71844810371623, 1.85839543138891, -2.24043225124719})}};
  return r;
}

MotionReference double_pendulum() {
  MotionReference r;
  r.name = "double pendulum of slender rods";
  r.source = "Lagrange's equations and DOP853 (scipy)";
  const Vector3d slender(0.0, 1.0 / 12.0, 1.0 / 12.0);
  r.tree.base_fixed = true;
  r.tree.bodies = {rod(-1, Vector3d::UnitZ(), 1.0, 1.0, slender), rod(0, Vector3d::UnitZ(), 1.0, 1.0, slender)};
  r.start = make_state(r.tree);
  r.gravity = k_gravity_y;
  r.tolerance = 1e-7;
  r.reason = "chaotic: errors grow a thousandfold in 3 s";
  r.known = {
      {0.5, vector_of({-1.12265370086265, 0.593820261371271}), vector_of({-2.41430831264868, -3.53479662346673})},
      {1.0, vector_of({-2.77851256498552, 0.393325215099257}), vector_of({-3.40651753297241, 2.89047206086875})},
      {2.0, vector_of({-1.65355463361567, 0.490120381731791}), vector_of({-0.961145444538547, 12.8601004975721})},
      {3.0, vector_of({-0.545710314505675, -0.529351364667532}), vector_of({-4.59335710547224, 5.77767798608666})}};
  return r;
}

MotionReference sprung_chain() {
  MotionReference r;
  r.name = "ten links on sprung hinges";
  r.source = "dense mass matrix and DOP853 (numpy, scipy)";
  r.tree = spring_chain();
  r.start = make_state(r.tree);
  r.gravity = k_gravity_z;
  r.torque = [](const TreeState& s) -> Eigen::VectorXd { return -400.0 * s.angle - 2.0 * s.rate; };
  r.tolerance = 1e-7;
  r.reason = "reference integrator at 0.25 ms";
  r.known = {
      {0.25,
       vector_of({0.340272338098916, 0.125388988220716, 0.00819535381898404, -0.0575762821959214, -0.0971424653180407,
                  -0.120659913357102, -0.126910546903844, -0.110266502874858, -0.0711786072296594,
                  -0.0243435849005238}),
       vector_of({1.35221923853852, 0.918440149311046, 0.715522216206089, 0.424212115643557, -0.0337676191352297,
                  -0.554899557492532, -0.944188208288101, -1.01964492080363, -0.73628809137298, -0.268149589245086})},
      {1.0,
       vector_of({1.20493441555391, 0.725691741400705, 0.432641257078562, 0.278953738789163, 0.195533195416228,
                  0.143079138643914, 0.103134794603777, 0.0683212979338001, 0.0369122700339324, 0.0114290720844902}),
       vector_of({-1.61870309522021, -0.603709975431938, 0.262146180249841, 0.933210489576684, 1.44823664228126,
                  1.73440925099264, 1.71794478095723, 1.3983512757025, 0.861841517453476, 0.289711593066663})},
      {2.0,
       vector_of({-0.17114322904073, 0.0199418220691286, 0.211156679554001, 0.333831186905467, 0.349071916672824,
                  0.263990128038541, 0.123007370951848, -0.00926559986683684, -0.068236210552297, -0.0392029973589914}),
       vector_of({-0.795822867976142, -1.64000126125103, -0.89901520951482, 1.46903223934788, 3.40399684659232,
                  2.46853922957981, -0.306755839785896, -1.89458446045533, -1.3157952983104, -0.255073248783308})}};
  return r;
}

Eigen::VectorXd sprung_chain_at_rest() {
  return vector_of({0.763587658328912, 0.38491088283666, 0.192671084852872, 0.0984708810346609, 0.0515629118782018,
                    0.0274322100365395, 0.0144857662669517, 0.00721116312113214, 0.00300924106219854,
                    0.000737063821760108});
}

MotionReference tilted_hinge_chain() {
  MotionReference r;
  r.name = "five bars on tilted hinges";
  r.source =
      "EXUDYN, TestModels/kinematicTreeTest.py (the sum to 14 digits); the angles one by one: dense mass matrix and "
      "DOP853";
  r.tree = tilted_chain();
  r.start = make_state(r.tree);
  r.gravity = Vector3d(0.0, -10.0, 0.0);
  r.tolerance = 1e-9;
  r.reason = "reference integrator at 0.25 ms";
  r.known = {
      {1.0,
       vector_of({-1.31995028365113, -0.0366712882624574, -0.0406165986580657, -0.606541632437449, 0.694395851603011}),
       vector_of({-0.875509921331599, -0.052461828300063, 5.54727016667428, -7.5421888422733, -0.419964649033323})}};
  return r;
}

HeavyTop::HeavyTop() {
  const double c = std::cos(k_pi * 150.0 / 180.0), s = std::sin(k_pi * 150.0 / 180.0);
  tree.base_fixed = true;
  for (const Vector3d& axis : {Vector3d(c, 0.0, s), Vector3d(-s, 0.0, c), Vector3d(0.0, 1.0, 0.0)}) {
    TreeBody body;
    body.parent = static_cast<int>(tree.bodies.size()) - 1;
    body.axis = axis;
    tree.bodies.push_back(body);
  }
  tree.bodies[2].mass = 15.0;
  tree.bodies[2].center_of_mass = Vector3d::UnitY();
  tree.bodies[2].inertia = Vector3d(0.234375, 0.46875, 0.234375).asDiagonal();
  start = make_state(tree);
  start.rate << -4.61538 * s, -4.61538 * c, 150.0;
  known = {
      {0.1, {0.421296658925353, 0.89457197434561, -0.149164700561938}, {4.80894133172804, 150.0, 1.02830075671713}},
      {0.2, {0.605550561376937, 0.598957681795005, -0.523983027430116}, {-2.69159091214124, 150.0, 4.91726098989518}},
      {0.5, {-0.7024682970568, -0.0211651847014087, -0.711400257651538}, {-0.471053101739472, 150.0, 5.90108304832423}},
      {1, {0.173343964098119, 0.640088592070025, -0.748490791134109}, {-0.822078101694425, 150.0, -5.92329134811428}},
      {2, {-0.15041682274695, -0.72416559163753, -0.673022269559469}, {0.122233219473889, 150.0, -5.85562458920283}}};
}

std::vector<HingedRod> adams_rods() {
  const Vector3d level = Vector3d::UnitY(), tilted = Vector3d(0.0, 1.0, 1.0).normalized();
  const TorqueLaw linear = [](const TreeState& s) -> Eigen::VectorXd { return -200.0 * s.angle - 10.0 * s.rate; };
  const TorqueLaw stiffening = [](const TreeState& s) -> Eigen::VectorXd {
    return -(s.angle.array() * (50.0 + 10.0 * s.angle.array().abs()) + 10.0 * s.rate.array()).matrix();
  };
  std::vector<HingedRod> rods{
      hinged_rod("revolute_joint/Revolute_Case01", no_torque, level, Vector3d::Zero(),
                 {{0.25, {1.97773, 0.0, -0.297651}, {4.22398, 0.0, -0.874888}, {0.0, 0.0, 0.0}},
                  {0.5, {1.66081, 0.0, -1.11432}, {13.2797, 0.0, -9.14925}, {0.0, 0.0, 0.0}},
                  {1.0, {-0.892381, 0.0, -1.78988}, {-11.4612, 0.0, -23.2273}, {0.0, 0.0, 0.0}},
                  {2.5, {-0.265506, 0.0, -1.9823}, {-3.77661, 0.0, -28.4357}, {0.0, 0.0, 0.0}},
                  {5.0, {-1.99968, 0.0, -0.0355587}, {-0.510225, 0.0, -0.248259}, {0.0, 0.0, 0.0}}}),
      hinged_rod("revolute_joint/Revolute_Case02", no_torque, tilted, {1.0, 2.0, 3.0},
                 {{0.25, {2.98884, 2.14916, 2.85084}, {2.12864, -4.624, -5.18246}, {-1.46271, 9.75177, -9.75177}},
                  {0.5, {2.82591, 2.57708, 2.42292}, {7.56095, -2.39407, -7.41259}, {-5.65927, 8.95304, -8.95304}},
                  {1.0, {1.0421, 3.4139, 1.5861}, {0.427164, 9.56081, -19.3673}, {-13.8654, 0.206446, -0.206446}},
                  {2.5, {-0.846888, 2.54268, 2.45732}, {-7.19193, -2.67074, -7.13638}, {-5.32214, -9.05632, 9.05632}},
                  {5.0, {1.20996, 3.4064, 1.5936}, {2.11895, 9.40977, -19.2164}, {-13.792, 1.0295, -1.0295}}}),
      hinged_rod("rotspring_force/RotSpring_Case01", linear, level, Vector3d::Zero(),
                 {{0.25, {1.990786, 0.0, -0.1917536}, {0.288163, 0.0, -12.15847}, {0.0, 24.26533, 0.0}},
                  {0.5, {1.977294, 0.0, -0.3005134}, {-0.6784321, 0.0, -14.44829}, {0.0, 29.00693, 0.0}},
                  {1.0, {1.994921, 0.0, -0.1424453}, {0.1710964, 0.0, -7.811281}, {0.0, 15.45839, 0.0}},
                  {2.5, {1.990319, 0.0, -0.1965414}, {0.009909953, 0.0, -9.728362}, {0.0, 19.35666, 0.0}},
                  {5.0, {1.990439, 0.0, -0.1953254}, {-0.002108525, 0.0, -9.828137}, {0.0, 19.5638, 0.0}}}),
      hinged_rod("rotspring_force/RotSpring_Case02", stiffening, level, Vector3d::Zero(),
                 {{0.25, {1.986612, 0.0, -0.2310275}, {1.541766, 0.0, -7.17423}, {0.0, 13.75658, 0.0}},
                  {0.5, {1.89736, 0.0, -0.632476}, {0.1317424, 0.0, -12.91623}, {0.0, 24.56881, 0.0}},
                  {1.0, {1.804202, 0.0, -0.8630493}, {-0.8843338, 0.0, -11.84937}, {0.0, 22.25312, 0.0}},
                  {2.5, {1.871598, 0.0, -0.7050667}, {-0.1812868, 0.0, -10.28674}, {0.0, 19.40613, 0.0}},
                  {5.0, {1.882432, 0.0, -0.6756116}, {0.008265755, 0.0, -9.783619}, {0.0, 18.41019, 0.0}}})};
  rods[1].moment_tolerance = 3e-3;  // its bearing turns the curves' force error of 1.2e-3 N over 2 m
  return rods;
}

HingedRod::At observe(const HingedRod& rod, const TreeState& state, double time) {
  const TreeAnswer answer = accelerate(rod.tree, state, rod.gravity, rod.torque(state));
  const Vector6d reaction = joint_reaction(answer.work, 0);  // on the rod
  return {time, state.position + answer.work.center_W(0), -reaction.tail<3>(), -reaction.head<3>()};
}

}  // namespace grouser::test
