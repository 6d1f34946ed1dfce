#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

namespace stickslip {

/// Whether the liquid goes along with a surface that moves, or stays where it is.
enum class Liquid { moves, rests };

/// Accelerations of the surface over one period, linear from point to point and played again and
/// again. They have no mean, nor has the velocity: otherwise the surface would drift away.
class Accelerations {
public:
    struct Point {
        double time = 0.0;          ///< s
        double x = 0.0, z = 0.0;    ///< m/s^2
        double vx = 0.0, vz = 0.0;  ///< m/s
        double sx = 0.0, sz = 0.0;  ///< m
    };

    /// From time and accelerations alone; the means are taken out, and the rest follows. Throws
    /// std::invalid_argument for fewer than two points, a first one that is not at time zero, times
    /// that do not rise, and numbers that are not finite.
    explicit Accelerations(std::vector<Point> points);

    const std::vector<Point>& points() const { return points_; }
    double period() const { return points_.back().time; }  ///< s
    /// Means along x and z that were taken out, m/s^2.
    const std::array<double, 2>& mean() const { return mean_; }

private:
    std::vector<Point> points_;
    std::array<double, 2> mean_ = {};
};

/// How the surface moves, seen from the ground: along itself (x) and along its normal (z).
struct ShakeParameters {
    /// One of the harmonics from the second on.
    struct Harmonic {
        double part = 0.0;   ///< of the amplitude
        double phase = 0.0;  ///< rad
    };
    using Harmonics = std::array<Harmonic, 3>;

    double frequency = 100.0;                     ///< Hz
    double amplitude_x = 0.0, amplitude_z = 0.0;  ///< m
    double phase = 0.0;                           ///< rad, of z
    Harmonics harmonics_x = {}, harmonics_z = {};
    std::shared_ptr<const Accelerations> accelerations;  ///< in place of the sines
    Liquid liquid = Liquid::moves;

    bool absent() const { return amplitude_x == 0.0 && amplitude_z == 0.0 && !accelerations; }
    /// Repetition rate, Hz.
    double rate() const { return accelerations ? 1.0 / accelerations->period() : frequency; }
};

/// Place, velocity and acceleration of the surface in the ground's frame: m, m/s, m/s^2.
struct SurfaceMotion {
    double x = 0.0, z = 0.0;
    double vx = 0.0, vz = 0.0;
    double ax = 0.0, az = 0.0;
};

/// The motion of the surface over a run, which begins at the place zero.
class Shake {
public:
    Shake() = default;
    /// sign: of the robot's x in the world.
    Shake(const ShakeParameters& parameters, double sign);

    bool absent() const { return terms_.empty() && !accelerations_; }
    bool carries_liquid() const { return liquid_ == Liquid::moves; }
    /// Motion of the surface. time: s, since the run began.
    SurfaceMotion at(double time) const { return at(time, time); }
    /// The same from the piece of the accelerations that contains the time `inside`.
    SurfaceMotion at(double time, double inside) const;

    /// The first time (s) after another at which the acceleration has a kink or jumps.
    double next_kink(double after) const;
    /// Period of the fastest sine, s; infinite without one.
    double shortest_period() const {
        return terms_.empty() ? std::numeric_limits<double>::infinity()
                              : 1.0 / (frequency_ * highest_);
    }
    /// Bounds on its speed and acceleration, m/s and m/s^2.
    double most_speed() const { return most_speed_; }
    double most_acceleration() const { return most_acceleration_; }

private:
    struct Term {
        double harmonic, phase;  // -, rad
        double x, z;             // m
    };

    void bound();

    std::vector<Term> terms_;
    std::shared_ptr<const Accelerations> accelerations_;
    double sign_ = 1.0;
    SurfaceMotion start_;
    double frequency_ = 1.0;  // Hz
    double highest_ = 1.0;
    double most_speed_ = 0.0, most_acceleration_ = 0.0;
    Liquid liquid_ = Liquid::moves;
};

}  // namespace stickslip
