#pragma once
#include <Eigen/Core>
#include <vector>

#include "model/vehicle.h"

/// An independent model of a vehicle on level ground: Lagrange's equations in its plane of symmetry, without friction
/// and damping. It shares the vehicle file with the simulator and nothing else.
///
/// Coordinates y: x, rise and pitch (nose down > 0) of the hull, arm angles front to rear, idler arm angle, all from
/// design; both sides move alike. Potential energy: weights; torsion bars M = K (theta_f - theta); gas p V^n through
/// the slider-crank; wheels on plates, K_p delta^(3/2), and links on ground points in series; the tensioner; the belt
/// of outer tangents round the moved wheels with tension T = (K / N) (L - N p), and its weight.
namespace grouser::test {

class PlaneVehicle {
 public:
  /// joint_stiffness: of one joint of the track along it [N/m].
  PlaneVehicle(Vehicle vehicle, double joint_stiffness, double gravity);

  struct Tensioner {
    double stiffness = 0.0, free = 0.0;  ///< N m/rad and rad, about the idler arm's pivot
  };
  struct Rest {
    Eigen::VectorXd y;
    Tensioner tensioner;
    std::vector<double> ground_loads;  ///< N, under each wheel of one side, front to rear
  };
  /// Rest with `tension` in the upper run, found through the free angle of a tensioner of `stiffness` [N/m].
  [[nodiscard]] Rest stand(double tension, double stiffness) const;

  /// A small vibration about rest.
  struct Mode {
    double frequency = 0.0;  ///< Hz
    Eigen::VectorXd shape;   ///< in y, of unit modal mass
    Eigen::VectorXd dual;    ///< M shape: its product with a motion in y picks this mode out
  };
  /// Modes from the lowest, the free surge left out; `stiffness` of the tensioner may differ from that of the rest, its
  /// force is kept.
  [[nodiscard]] std::vector<Mode> modes(const Rest& rest, double stiffness) const;

  /// Tension of the upper run [N] when links pass at `link_rate` [1/s] in the rest's place, on a tensioner of
  /// `stiffness` whose force at rest was that of `rest`. A belt that runs carries rho v^2 beside what presses on its
  /// wheels: Routh's function has -(1/2) N m (link_rate L / N)^2 in its potential.
  [[nodiscard]] double running_tension(const Rest& rest, double stiffness, double link_rate) const;

 private:
  struct Body {
    double mass, inertia, x, z, angle;
  };
  struct Belt {
    double length = 0.0;  ///< m, of pin line
    double moment = 0.0;  ///< integral of z along it [m^2]
  };
  /// What the potential depends on beside the coordinates.
  struct Setting {
    Tensioner tensioner;
    double link_rate = 0.0;  ///< 1/s
  };
  [[nodiscard]] const RunningGear& gear() const { return vehicle_.side(Side::left); }
  [[nodiscard]] std::vector<Body> bodies(const Eigen::VectorXd& y) const;
  [[nodiscard]] std::vector<Body> track_bodies(const Eigen::VectorXd& y) const;
  [[nodiscard]] Belt belt(const Eigen::VectorXd& y) const;
  [[nodiscard]] double upper_tension(const Eigen::VectorXd& y) const;
  [[nodiscard]] double ground_load(const Eigen::VectorXd& y, int station) const;
  [[nodiscard]] double potential(const Eigen::VectorXd& y, const Setting& setting) const;
  [[nodiscard]] Eigen::MatrixXd stiffness_matrix(const Eigen::VectorXd& y, const Setting& setting) const;
  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Eigen::VectorXd& y) const;
  [[nodiscard]] Eigen::VectorXd settle(Eigen::VectorXd y, const Setting& setting) const;

  [[nodiscard]] double belt_stiffness() const { return joint_stiffness_ / gear().track.num_links; }
  /// A tensioner of `stiffness` [N/m] with the force of the rest's.
  [[nodiscard]] Tensioner exchanged(const Rest& rest, double stiffness) const;

  Vehicle vehicle_;
  double joint_stiffness_, gravity_;
  int num_stations_;
};

}  // namespace grouser::test
