#include <doctest/doctest.h>

#include <cmath>

#include "impact_draws.hpp"

using namespace stickslip;
using stickslip::test::paper_model;

/// Impacts whose outcome can be worked out on paper.
namespace {

// Half length b, half height h and r^2 = b^2 + h^2; J = m r^2 / 3.
constexpr double b = 125e-6, h = 50e-6;

// Pivots on its front corner, which sticks or slips with `slip` (m/s), as the rear comes down.
BodyState rear_comes_down(double omega, double slip = 0.0) {
    BodyState before;
    before.omega = -omega;
    before.vz = -omega * b;
    before.vx = -omega * h + slip;
    return before;
}

}  // namespace

TEST_CASE("flat robot, rear lands: the old contact has mu_s and the new one mu_k") {
    // To stop it all at once takes, per m omega: N_front + N_rear = b and T = h along x, and about
    // the centre b (N_rear - N_front) = r^2/3 + h^2:
    //   N_front = (b^2 - 2 h^2) / (3 b) = 28.33 um, N_rear = (2 b^2 + 2 h^2) / (3 b) = 96.67 um.
    // It stops if h <= mu_s N_front + mu_k N_rear: with mu_k = 0.35 for mu_s of at least 0.5706.
    // (With the coefficients exchanged the limit would be 0.4147.)
    const double front = (b * b - 2.0 * h * h) / (3.0 * b);
    const double rear = (2.0 * b * b + 2.0 * h * h) / (3.0 * b);
    const double limit = (h - 0.35 * rear) / front;
    CHECK(limit == doctest::Approx(0.5706).epsilon(1e-4));

    Model model = paper_model();
    const double omega = 500.0;
    for (const double offset : {1e-9, 0.1}) {
        model.friction = {limit + offset, 0.35};
        const ImpactResult result =
            face_impact(model, rear_comes_down(omega), Arrival::behind, false);
        CHECK(result.touch == Touch::face);
        CHECK(result.slip_velocity == 0.0);
        CHECK(result.body.vx == 0.0);
        CHECK(result.body.vz == 0.0);
        CHECK(result.body.omega == 0.0);
    }
    for (const double offset : {1e-9, 0.1}) {
        model.friction = {limit - offset, 0.35};
        const ImpactResult result =
            face_impact(model, rear_comes_down(omega), Arrival::behind, false);
        CHECK(result.touch == Touch::face);
        CHECK(result.slip_velocity < 0.0);
    }
}

TEST_CASE("flat robot, rear lands: the slip that is left, with the coefficients of Table II") {
    // S = N_front + N_rear = b and D = N_rear - N_front = (r^2/3 + h T) / b, T = mu_s N_front +
    // mu_k N_rear = mu S - delta D, with mu = (mu_s + mu_k)/2 and delta = (mu_s - mu_k)/2.
    const double mu_s = 0.2, mu_k = 0.145, mu = 0.1725, delta = 0.0275;
    const double third = (b * b + h * h) / 3.0;
    const double tangential = (mu * b - delta * third / b) / (1.0 + delta * h / b);
    const double omega = 500.0;
    Model model = paper_model();
    model.friction = {mu_s, mu_k};
    const ImpactResult result = face_impact(model, rear_comes_down(omega), Arrival::behind, false);
    CHECK(result.touch == Touch::face);
    CHECK(result.slip_velocity == doctest::Approx(omega * (tangential - h)).epsilon(1e-12));
    CHECK(result.body.vx == result.slip_velocity);
    CHECK(result.body.omega == 0.0);

    // A front that was slipping has mu_k too, here another one each way: T = -way (1 + 0.3 way)
    // mu_k S.
    model.laws = LawSet(
        {{{Quantity::directional_friction, Acts::multiplies, Argument::slip_sign, Form::line},
          0.3}});
    for (const double slip_sign : {-1.0, 1.0}) {
        const double slip = slip_sign * 0.1,
                     friction = -slip_sign * (1.0 + 0.3 * slip_sign) * mu_k * b;
        const ImpactResult sliding =
            face_impact(model, rear_comes_down(omega, slip), Arrival::behind, true);
        const double left = slip + omega * (friction - h);
        CHECK(sliding.slip_velocity == doctest::Approx(left).epsilon(1e-12));
    }
}

TEST_CASE("rocking block: a tall one rolls over, and keeps 1 - 3/2 sin^2 alpha of its rate") {
    // Housner 1963: what is kept is the angular momentum about the new corner, J omega + m (H^2 -
    // B^2) omega before, with half base B and half height H of the standing block, and (J + m r^2)
    // omega' after. With J = m r^2/3 and alpha = atan(B/H) the ratio is 1 - 3/2 sin^2(alpha).
    Model model = paper_model();
    model.friction = {5.0, 5.0};
    const double alpha = std::atan(h / b), sine = std::sin(alpha);
    const double ratio = 1.0 - 1.5 * sine * sine;
    for (const double omega : {-800.0, -1.0, 2.0, 500.0}) {
        const bool falls_back = omega < 0.0;
        BodyState before;
        before.quadrant = 1;  // standing on the short face
        before.omega = omega;
        before.vz = -std::abs(omega) * h;
        before.vx = omega * b;
        const ImpactResult result =
            face_impact(model, before, falls_back ? Arrival::behind : Arrival::ahead, false);
        CHECK(result.touch == Touch::corner);
        CHECK(result.slip_velocity == 0.0);
        CHECK(result.body.omega == doctest::Approx(ratio * omega).epsilon(1e-12));
        // On the rear end, which is the pivot of the quadrant before, or on the front end.
        CHECK(result.body.quadrant == (falls_back ? 0 : 1));
        CHECK(result.body.angle == (falls_back ? kQuarterTurn : 0.0));
    }
}

TEST_CASE("rocking block: a block wider than sqrt(2) times its height does not rock") {
    // N_front = (b^2 - 2 h^2) / (3 b) of the first case changes sign there.
    Model model = paper_model();
    model.friction = {50.0, 50.0};
    for (const double ratio : {1.40, 1.43}) {
        model.shape = Rectangle(2.0 * ratio * h, 2.0 * h);
        model.inertia = model.mass * h * h * (1.0 + ratio * ratio) / 3.0;
        BodyState before;
        before.omega = -500.0;
        before.vz = -500.0 * ratio * h;
        before.vx = -500.0 * h;
        const ImpactResult result = face_impact(model, before, Arrival::behind, false);
        CHECK(result.touch == (ratio * ratio > 2.0 ? Touch::face : Touch::corner));
    }
}

TEST_CASE("corner impact: a corner that sticks rebounds no faster than its energy allows") {
    // With inverse masses g at the corner, E = u'G^-1 u/2 and the tangential velocity t stopped, a
    // normal velocity n can at most come back as w^2 = n^2 - 2 n t g_nt/g_tt + t^2 g_nn/g_tt. At
    // theta + phi = 45 degrees m g = 5/2, 5/2 and 3/2, so t = 3/5 n gives w = 4/5 n.
    Model model = paper_model();
    model.friction = {50.0, 50.0};
    model.restitution = 1.0;
    const double phi = std::atan2(h, b), angle = kQuarterTurn / 2 - phi;
    const Pose pose = model.shape.pose(0, std::cos(angle), std::sin(angle));
    BodyState before;
    before.angle = angle;
    before.vz = -0.1;
    for (const double slip : {-0.06, 0.06}) {
        before.vx = slip;
        const ImpactResult result = corner_impact(model, pose, before);
        CHECK(result.slip_velocity == 0.0);
        CHECK(corner_velocity_z(pose, result.body.vz, result.body.omega) ==
              doctest::Approx(slip < 0.0 ? 0.08 : 0.1).epsilon(1e-12));
    }
}

TEST_CASE("impact: below the capture speed nothing rebounds") {
    Model model = paper_model();
    model.restitution = 1.0;
    BodyState before;
    for (const double speed : {0.99 * kCaptureSpeed, 1.01 * kCaptureSpeed}) {
        before.vz = -speed;
        const bool captured = speed <= kCaptureSpeed;
        CHECK(face_impact(model, before, Arrival::both, false).touch ==
              (captured ? Touch::face : Touch::none));
        const Pose pose = model.shape.pose(0, std::cos(0.4), std::sin(0.4));
        CHECK(corner_impact(model, pose, before).touch == (captured ? Touch::corner : Touch::none));
    }
    // A face that rocks as slowly lies still, a stuck one without any slip.
    const ImpactResult rest =
        face_impact(model, rear_comes_down(0.4 * kCaptureSpeed / b), Arrival::behind, false);
    CHECK(rest.touch == Touch::face);
    CHECK(rest.slip_velocity == 0.0);
}
