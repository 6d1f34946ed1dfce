#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "stickslip/contact/dynamics.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::in_coil_field;
using stickslip::test::in_uniform_field;
using stickslip::test::kRounding;
using stickslip::test::paper_coils;
using stickslip::test::paper_model;
using stickslip::test::Random;

namespace {

// The magnet alone: no weight, no drag, no adhesion.
Model magnet() {
    Model model = paper_model();
    model.gravity_x = model.gravity_z = 0.0;
    model.translational_drag = model.rotational_drag_linear = model.rotational_drag_quadratic = 0.0;
    model.adhesion = {};
    return model;
}

Load load_at(Dynamics& dynamics, const BodyState& body) {
    dynamics.set_quadrant(body.quadrant);
    dynamics.rebase_field(body.x, body.z);
    const Pose pose = dynamics.pose(body.angle);
    return dynamics.load(dynamics.field_at(0.0), body.x, body.z, pose, body.vx, body.vz,
                         body.omega);
}

BodyState random_body(Random& random) {
    BodyState body;
    body.quadrant = random.integer(-5, 5);
    body.angle = random.between(0.0, kQuarterTurn);
    body.x = random.between(-0.01, 0.01);
    body.z = random.between(0.0, 0.005);
    body.vx = random.between(-0.1, 0.1);
    body.vz = random.between(-0.1, 0.1);
    body.omega = random.between(-1000.0, 1000.0);
    return body;
}

}  // namespace

TEST_CASE("load: Eqs. (8) and (9) from the field of the coils, at any angle and misalignment") {
    Random random(1);
    for (int n = 0; n < 300; ++n) {
        Model model = magnet();
        model.misalignment = n % 3 == 0 ? 0.0 : random.between(-3.0, 3.0);
        PerCoil currents;
        for (double& current : currents) current = random.between(-7.0, 7.0);
        Dynamics dynamics = in_coil_field(model, currents);
        const BodyState body = random_body(random);
        const Load load = load_at(dynamics, body);

        const FieldAndGradient at = paper_coils().field(
            {body.x, 0.0, body.z}, Currents(Eigen::Map<const Currents>(currents.data())));
        const double direction = body.theta() + model.misalignment;
        const Eigen::Vector3d moment =
            model.moment * Eigen::Vector3d(std::cos(direction), 0.0, -std::sin(direction));
        const Eigen::Vector3d force = at.gradient * moment;
        // Angles of up to 12 rad carry 12 roundings, products and sums a few; five coils of 7 mT
        // and 0.13 T/m at most each may cancel.
        CHECK(std::abs(load.torque - moment.cross(at.field).y()) <
              32.0 * kRounding * model.moment * 5.0 * 7e-3);
        CHECK(std::abs(load.fx - force.x()) < 32.0 * kRounding * model.moment * 5.0 * 0.13);
        CHECK(std::abs(load.fz - force.z()) < 32.0 * kRounding * model.moment * 5.0 * 0.13);
        CHECK(load.contact_adhesion == 0.0);
    }
}

TEST_CASE("load: forces and torque are the slopes of the potential energy -m.B") {
    Random random(2);
    for (int n = 0; n < 100; ++n) {
        Model model = magnet();
        model.misalignment = random.between(-0.3, 0.3);
        PerCoil currents;
        for (double& current : currents) current = random.between(-7.0, 7.0);
        Dynamics dynamics = in_coil_field(model, currents);
        const Currents vector(Eigen::Map<const Currents>(currents.data()));
        const auto energy = [&](double x, double z, double theta) {
            const Eigen::Vector3d field = paper_coils().field({x, 0.0, z}, vector).field;
            const double direction = theta + model.misalignment;
            return -model.moment *
                   (std::cos(direction) * field.x() - std::sin(direction) * field.z());
        };
        const BodyState body = random_body(random);
        const double theta = body.theta();
        const Load load = load_at(dynamics, body);
        // Central differences. Lengths: fields vary over 0.1 m, so h = 20 um truncates at
        // (h/0.1)^2/6 = 7e-9, and rounds at 1e-16 0.1/h = 5e-13. Angle: h^2/6 = 2e-9 at 1e-4.
        const double h = 2e-5, t = 1e-4;
        const double size = model.moment * 5.0 * 7e-3;
        const double fx = -(energy(body.x + h, body.z, theta) - energy(body.x - h, body.z, theta));
        const double fz = -(energy(body.x, body.z + h, theta) - energy(body.x, body.z - h, theta));
        const double torque =
            -(energy(body.x, body.z, theta + t) - energy(body.x, body.z, theta - t));
        CHECK(std::abs(load.fx - fx / (2.0 * h)) < 4.0 * 7e-9 * size / 0.1);
        CHECK(std::abs(load.fz - fz / (2.0 * h)) < 4.0 * 7e-9 * size / 0.1);
        CHECK(std::abs(load.torque - torque / (2.0 * t)) < 2e-9 * size);
    }
}

TEST_CASE("load: signs. A clamp field downwards tilts nose-down, towards atan(-Bz/Bx)") {
    const Model model = magnet();
    Dynamics dynamics = in_uniform_field(model, 2e-3, -1e-3);
    BodyState body;
    CHECK(load_at(dynamics, body).torque > 0.0);  // flat: turns towards larger theta
    body.angle = std::atan(0.5);
    // Two products of moment 1.6e-9 and field 1e-3 that cancel.
    CHECK(std::abs(load_at(dynamics, body).torque) < 4.0 * kRounding * model.moment * 2e-3);
    body.angle += 0.01;
    CHECK(load_at(dynamics, body).torque < 0.0);
}

TEST_CASE("load: torque at the centre is 10.56 uN mm for 6.5 mT across the moment") {
    const Model model = magnet();
    Dynamics dynamics = in_uniform_field(model, 0.0, -6.5e-3);
    // 5e5 A/m times 250 x 130 x 100 um^3 times 6.5 mT.
    const double expected = 5e5 * 250e-6 * 130e-6 * 100e-6 * 6.5e-3;
    CHECK(expected == doctest::Approx(10.56e-9).epsilon(5e-4));
    CHECK(load_at(dynamics, {}).torque == doctest::Approx(expected).epsilon(1e-14));
}

TEST_CASE("load: weight, and its part along a tilted surface") {
    Model model = magnet();
    model.gravity_x = 3.0;
    model.gravity_z = -9.0;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    const Load load = load_at(dynamics, {});
    CHECK(load.fx == doctest::Approx(model.mass * 3.0).epsilon(1e-15));
    CHECK(load.fz == doctest::Approx(-model.mass * 9.0).epsilon(1e-15));
    CHECK(load.torque == 0.0);
}

TEST_CASE("drag: Eqs. (18) and (19), and it takes energy whatever the direction") {
    Model model = magnet();
    model.translational_drag = 1e-5;
    model.rotational_drag_quadratic = 9e-17;
    model.rotational_drag_linear = 2e-15;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    Random random(3);
    for (int n = 0; n < 200; ++n) {
        const BodyState body = random_body(random);
        const Load load = load_at(dynamics, body);
        CHECK(load.fx == doctest::Approx(-1e-5 * body.vx).epsilon(1e-14));
        CHECK(load.fz == doctest::Approx(-1e-5 * body.vz).epsilon(1e-14));
        const double turning = 2e-15 * body.omega + 9e-17 * std::abs(body.omega) * body.omega;
        CHECK(load.torque == doctest::Approx(-turning).epsilon(1e-14));
        CHECK(load.fx * body.vx + load.fz * body.vz < 0.0);
        CHECK(load.torque * body.omega < 0.0);
    }
}

TEST_CASE("angle drag: larger by the factor 1 + k cos^2 theta, in every quadrant") {
    Model model = magnet();
    model.translational_drag = 1e-5;
    model.angle_drag = 0.7;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    Random random(4);
    for (int n = 0; n < 200; ++n) {
        const BodyState body = random_body(random);
        const double cosine = std::cos(body.theta());
        const double drag = 1e-5 * (1.0 + 0.7 * cosine * cosine);
        // theta of up to 12 rad has 12 roundings.
        CHECK(load_at(dynamics, body).fx == doctest::Approx(-drag * body.vx).epsilon(1e-14));
        CHECK(load_at(dynamics, body).fz == doctest::Approx(-drag * body.vz).epsilon(1e-14));
    }
}

TEST_CASE("pose: that of the C library but for rounding, in every quadrant and turns beyond") {
    const Model model = paper_model();
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (const int quadrant : {0, 1, -6}) {
        dynamics.set_quadrant(quadrant);
        for (const double angle :
             {-0.1, 0.0, 1e-9, 0.4, 0.785, 1.2, kQuarterTurn, 1.68, 1.69, -0.12, 3.0, -40.0}) {
            const Pose pose = dynamics.pose(angle);
            const Pose direct = model.pose(quadrant, angle);
            // That of `cosine_and_sine`, and what an angle of 40 loses; then two roundings.
            const double tolerance = (4.0 + std::abs(angle)) * kRounding;
            CHECK(std::abs(pose.cosine - direct.cosine) < tolerance);
            CHECK(std::abs(pose.sine - direct.sine) < tolerance);
            CHECK(std::abs(pose.lever - direct.lever) < 2.0 * tolerance * model.shape.radius());
            CHECK(std::abs(pose.height - direct.height) < 2.0 * tolerance * model.shape.radius());
            CHECK(pose.angle == angle);
        }
        // Where a face lies flat.
        CHECK(dynamics.pose(0.0).cosine == 1.0);
        CHECK(dynamics.pose(0.0).sine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).cosine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).sine == 1.0);
    }
}

// ----- adhesion with a range -----

namespace {

constexpr double kStrength = 0.22e-6;  // N

Model sticky(double range) {
    Model model = magnet();
    model.adhesion = {kStrength, range};
    return model;
}

Load adhesion_load(Dynamics& dynamics, int quadrant, double angle, double gap) {
    dynamics.set_quadrant(quadrant);
    dynamics.rebase_field(0.0, 1e-4);
    const Pose pose = dynamics.pose(angle);
    return dynamics.load_near_surface(dynamics.field_at(0.0), 0.0, pose.height + gap, pose, 0.0,
                                      0.0, 0.0, gap);
}

// In flight with its centre at height z.
Load flight_load(Dynamics& dynamics, int quadrant, double angle, double z) {
    dynamics.set_quadrant(quadrant);
    const double height = dynamics.pose(angle).height;
    return adhesion_load(dynamics, quadrant, angle, std::max(z - height, 1e-300));
}

// 1 - gap/range of the four corners, no less than zero.
std::array<double, 4> corner_weights(const Model& model, int quadrant, double angle, double z) {
    const double b = model.shape.half_base(quadrant), h = model.shape.half_rise(quadrant);
    const double c = std::cos(angle), s = std::sin(angle);
    const std::array<std::array<double, 2>, 4> body = {{{b, -h}, {b, h}, {-b, h}, {-b, -h}}};
    std::array<double, 4> weights;
    for (std::size_t i = 0; i < 4; ++i) {
        const double gap = z + body[i][1] * c - body[i][0] * s;
        weights[i] = std::clamp(1.0 - gap / model.adhesion.range, 0.0, 1.0);
    }
    return weights;
}

// -strength range max(f.w - f.f/2) over shares f that are not negative and add up to at most one,
// by trying all sets of corners that pull.
double adhesion_potential(const Model& model, int quadrant, double angle, double z) {
    const std::array<double, 4> weights = corner_weights(model, quadrant, angle, z);
    double best = 0.0;
    for (unsigned set = 1; set < 16; ++set) {
        double sum = 0.0;
        int count = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            if (set >> i & 1u) {
                sum += weights[i];
                ++count;
            }
        }
        const double level = std::max(0.0, (sum - 1.0) / count);
        double value = 0.0;
        bool allowed = true;
        for (std::size_t i = 0; i < 4; ++i) {
            if (!(set >> i & 1u)) continue;
            const double share = weights[i] - level;
            allowed = allowed && share >= 0.0;
            value += share * (weights[i] - 0.5 * share);
        }
        if (allowed) best = std::max(best, value);
    }
    const double sine = std::sin(angle + quadrant * kQuarterTurn);
    return -kStrength * (1.0 - model.adhesion.smooth.angle_loss * sine * sine) *
           model.adhesion.range * best;
}

}  // namespace

TEST_CASE("adhesion without range pulls at contact only") {
    const Model model = sticky(0.0);
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    const Load touching = adhesion_load(dynamics, 0, 0.3, 0.0);
    CHECK(touching.contact_adhesion == kStrength);
    CHECK(touching.fz == 0.0);
    CHECK(touching.torque == 0.0);
}

TEST_CASE("adhesion with a range: of two corners that touch each has half") {
    const Model model = sticky(1e-6);
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    const double half = 0.5 * kStrength;
    const Load flat = adhesion_load(dynamics, 0, 0.0, 0.0);
    CHECK(flat.contact_adhesion == doctest::Approx(half).epsilon(1e-15));
    CHECK(flat.fz == doctest::Approx(-half).epsilon(1e-15));
    // The pull at the rear corner turns the nose up.
    CHECK(flat.torque == doctest::Approx(-125e-6 * half).epsilon(1e-14));
    const Load on_end = adhesion_load(dynamics, 0, kQuarterTurn, 0.0);
    CHECK(on_end.contact_adhesion == doctest::Approx(half).epsilon(1e-9));
    CHECK(on_end.torque == doctest::Approx(50e-6 * half).epsilon(1e-9));
}

TEST_CASE("adhesion with a range: to pull one corner off takes half strength times range") {
    const double range = 2e-6;
    const Model model = sticky(range);
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    // Linear in the gap, so the trapezoidal rule is exact; it has to start just above contact.
    constexpr int parts = 1000;
    double work = 0.0;
    for (int i = 0; i <= parts; ++i) {
        const double gap = range * std::max(1e-12, static_cast<double>(i) / parts);
        const double weight = (i == 0 || i == parts ? 0.5 : 1.0) * range / parts;
        work -= weight * adhesion_load(dynamics, 0, 0.5, gap).fz;
    }
    CHECK(work == doctest::Approx(0.5 * kStrength * range).epsilon(1e-9));
}

TEST_CASE("adhesion with a range: its wrench is the gradient of a potential") {
    const double range = 2e-5;
    Random random(5);
    int near_two = 0, near_three = 0;
    for (int n = 0; n < 2000; ++n) {
        Model model = sticky(random.coin() ? range : 1e-4);
        if (random.coin()) model.adhesion.smooth.angle_loss = random.between(-2.0, 1.0);
        Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
        const int quadrant = random.integer(-4, 4);
        // In flight the angle may run out of its quadrant.
        const double angle =
            random.coin() ? random.between(-0.1, 0.3) : kQuarterTurn + random.between(-0.3, 0.1);
        const double z = model.shape.half_base(quadrant) * std::abs(std::sin(angle)) +
                         model.shape.half_rise(quadrant) * std::abs(std::cos(angle)) +
                         random.between(1e-3, random.coin() ? 0.05 : 1.2) * model.adhesion.range;
        const std::array<double, 4> weights = corner_weights(model, quadrant, angle, z);
        const auto acting =
            std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; });
        near_two += acting == 2;
        near_three += acting == 3;
        const Load load = flight_load(dynamics, quadrant, angle, z);
        // Central differences: rounding 1e-16 / 1e-6 of the potential, and kinks where a corner
        // comes into range, of the part of the step by which it may be on the other side.
        const double step = 1e-6 * model.adhesion.range, turn = step / 1.3e-4;
        const auto potential = [&](double da, double dz) {
            return adhesion_potential(model, quadrant, angle + da, z + dz);
        };
        const double fz = -(potential(0.0, step) - potential(0.0, -step)) / (2.0 * step);
        const double torque = -(potential(turn, 0.0) - potential(-turn, 0.0)) / (2.0 * turn);
        CHECK(std::abs(load.fz - fz) < 3e-6 * kStrength);
        CHECK(std::abs(load.torque - torque) < 3e-6 * 3.0 * kStrength * 1.35e-4);
    }
    CHECK(near_two > 200);
    CHECK(near_three > 50);
}

TEST_CASE("adhesion with a range: no work on a closed path of height and angle") {
    Model model = sticky(2e-5);
    // The knots of a free shape are crossed too.
    const FreeCurve bent({FreeReach::both_ways, 0.1, {0.0, 0.8, 0.1, -0.5, 0.8}});
    for (const auto& [loss, curve] :
         {std::pair{0.0, FreeCurve()}, {0.7, FreeCurve()}, {0.0, bent}, {0.7, bent}}) {
        model.adhesion.smooth.angle_loss = loss;
        model.adhesion.angle = curve;
        Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
        // An ellipse over the lying face, of no mirror symmetry, which comes within range of one
        // corner, of the other and of both.
        constexpr int parts = 20000;
        double work = 0.0, size = 0.0;
        for (int i = 0; i < parts; ++i) {
            const double phase = 2.0 * std::numbers::pi * i / parts;
            const double theta = 0.02 + 0.05 * std::sin(phase);
            const double z = 50e-6 + 15e-6 - 9e-6 * std::cos(phase);
            const int quadrant = theta < 0.0 ? -1 : 0;
            const Load load = flight_load(dynamics, quadrant, theta - quadrant * kQuarterTurn, z);
            const double power =
                load.fz * 9e-6 * std::sin(phase) + load.torque * 0.05 * std::cos(phase);
            work += power * 2.0 * std::numbers::pi / parts;
            size += std::abs(power) * 2.0 * std::numbers::pi / parts;
        }
        CHECK(size > kStrength * 5e-6);
        // Exact over a period but for some kinks of the wrench, each with an error of (2 pi/n)^2/8
        // of the change of slope.
        CHECK(std::abs(work) < 1e-7 * size);
    }
}

TEST_CASE("adhesion with a range: the touching corners never pull more than its strength") {
    const double range = 2e-5;
    const Model model = sticky(range);
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (double lift = 0.0; lift < 1.3; lift += 0.01) {
        // The rear corner at `lift` ranges while the front corner touches.
        const Load load = adhesion_load(dynamics, 0, std::asin(lift * range / 250e-6), 0.0);
        const double rear = 0.5 * std::max(0.0, 1.0 - lift);
        CHECK(load.contact_adhesion == doctest::Approx(kStrength * (1.0 - rear)).epsilon(1e-12));
        CHECK(load.contact_adhesion - load.fz == doctest::Approx(kStrength).epsilon(1e-12));
    }
}

TEST_CASE("adhesion with a range: contact and the gap that closes on it pull alike") {
    const Model model = sticky(1e-6);
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (const double angle : {0.0, 1e-3, 0.3}) {
        const Load contact = adhesion_load(dynamics, 0, angle, 0.0);
        const Load flight = adhesion_load(dynamics, 0, angle, 1e-18);
        const Pose pose = dynamics.pose(angle);
        CHECK(flight.contact_adhesion == 0.0);
        // A gap of 1e-18 m is 1e-12 of the range.
        CHECK(flight.fz == doctest::Approx(contact.fz - contact.contact_adhesion).epsilon(1e-11));
        CHECK(std::abs(flight.torque - contact.torque - pose.lever * contact.contact_adhesion) <
              1e-11 * kStrength * 1.35e-4);
    }
}
