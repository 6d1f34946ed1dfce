#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "stickslip/contact/contact.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

constexpr std::size_t kForms = 8;

std::optional<Law> law_of(const LawKind& kind, Random& random) {
    Law law{kind, random.between(-0.9, 2.0), random.between(0.1, 3.0)};
    law.curve = {random.coin() ? FreeReach::both_ways : FreeReach::anchored, law.scale, {}};
    for (double& knot : law.curve.knots) knot = random.between(-0.9, 2.0);
    try {
        const LawSet checked({law});
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
    return law;
}

/// One of each kind that there is.
std::vector<Law> all_laws(Random& random) {
    std::vector<Law> result;
    for (std::size_t q = 0; q < kQuantities; ++q) {
        for (std::size_t a = 0; a < kArguments; ++a) {
            for (std::size_t f = 0; f < kForms; ++f) {
                for (const Acts acts : {Acts::adds, Acts::multiplies}) {
                    const auto law = law_of({Quantity(q), acts, Argument(a), Form(f)}, random);
                    if (law) result.push_back(*law);
                }
            }
        }
    }
    return result;
}

/// A contact and a body in the units of the laws' scales, so that each law counts.
struct Motion {
    int quadrant;
    double angle, x, slip, vx, vz, omega, normal, slip_sign, time, age;
};
Motion random_motion(Random& random) {
    return {random.integer(-4, 4),     random.between(-3.0, 3.0), random.between(-2.0, 2.0),
            random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-2.0, 2.0),
            random.between(-2.0, 2.0), random.between(0.0, 2.0),  random.coin() ? 1.0 : -1.0,
            random.between(0.0, 2.0),  random.between(-0.5, 2.0)};
}

double argument_of(const Law& law, const Motion& m) {
    const double theta = m.quadrant * kQuarterTurn + m.angle;
    switch (law.kind.argument) {
        case Argument::slip_sign:
            return m.slip_sign;
        case Argument::slip_speed:
            return std::abs(m.slip);
        case Argument::place:
            return m.x;
        case Argument::tilt:
            return std::atan2(std::sin(theta), std::cos(theta));
        case Argument::sine:
            return std::sin(theta);
        case Argument::cosine:
            return std::cos(theta);
        case Argument::load:
            return m.normal;
        case Argument::time:
            return m.time;
        case Argument::age:
            return std::max(m.age, 0.0);
        case Argument::speed:
            return std::hypot(m.vx, m.vz);
        case Argument::rate:
            break;
    }
    return std::abs(m.omega);
}

double form_of(const Law& law, const Motion& m) {
    const double u = argument_of(law, m) / law.scale;
    switch (law.kind.form) {
        case Form::line:
            return u;
        case Form::square:
            return u * u;
        case Form::gaussian:
            return std::exp(-u * u);
        case Form::exponential:
            return std::exp(-std::abs(u));
        case Form::logarithm:
            return std::log(1.0 + std::abs(u));
        case Form::saturation:
            return u * u / (1.0 + u * u);
        case Form::wave:
            return std::sin(u);
        case Form::curve:
            break;
    }
    return FreeCurve(law.curve).at(argument_of(law, m));
}

/// Quantities that laws act on, of magnitudes near one.
struct Values {
    double sticks, slips, adhesion, drag, rotational_drag;
};

Model robot(const std::vector<Law>& laws) {
    Model model = paper_model();
    model.friction = {0.8, 0.6};
    model.adhesion = 0.5;
    model.translational_drag = 0.9;
    model.rotational_drag_linear = 0.7;
    model.laws = LawSet(laws);
    return model;
}

Values values_of(const Model& model, const Motion& m) {
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    dynamics.set_quadrant(m.quadrant);
    dynamics.set_start(m.time);
    dynamics.set_contact_age(m.age);
    const Pose pose = dynamics.pose(m.angle);
    const Load load = dynamics.load(dynamics.field_at(0.0), m.x, 0.0, pose, m.vx, m.vz, m.omega);
    const double rotational =
        (-load.torque / m.omega) - model.rotational_drag_quadratic * std::abs(m.omega);
    return {dynamics.static_limit(m.slip_sign, m.x, pose, m.normal, 0.0),
            dynamics.kinetic(m.slip_sign, m.slip, m.x, pose, m.normal, 0.0), load.contact_adhesion,
            load.drag, rotational};
}

void expect(const Law& law, const Motion& m, Values& v) {
    const double part = law.amplitude * form_of(law, m);
    const auto change = [&](double& value) {
        value = law.kind.acts == Acts::adds ? value + part : value * std::max(1.0 + part, 0.0);
    };
    switch (law.kind.quantity) {
        case Quantity::sliding_friction:
            return change(v.slips);
        case Quantity::friction:
        case Quantity::directional_friction:
        case Quantity::friction_by_load:
            change(v.sticks);
            return change(v.slips);
        case Quantity::adhesion:
            return change(v.adhesion);
        case Quantity::drag:
            return change(v.drag);
        case Quantity::rotational_drag:
            return change(v.rotational_drag);
        case Quantity::fluid:
            change(v.drag);
            change(v.rotational_drag);
    }
}

void check_near(const Values& a, const Values& b) {
    const auto near = [](double value) { return doctest::Approx(value).epsilon(1e-12); };
    CHECK(a.sticks == near(b.sticks));
    CHECK(a.slips == near(b.slips));
    CHECK(a.adhesion == near(b.adhesion));
    CHECK(a.drag == near(b.drag));
    CHECK(a.rotational_drag == near(b.rotational_drag));
}

}  // namespace

TEST_CASE("law: each that there is does what its formula says") {
    Random random(1);
    const std::vector<Law> laws = all_laws(random);
    CHECK(laws.size() == 16 + 80 + 2 + 8 + 3 * 112 + 56);
    for (const Law& law : laws) {
        const Model model = robot({law});
        for (int n = 0; n < 10; ++n) {
            const Motion m = random_motion(random);
            Values expected = values_of(robot({}), m);
            expect(law, m, expected);
            check_near(values_of(model, m), expected);
        }
    }
}

TEST_CASE("laws: one after another, those that add to a quantity first") {
    Random random(2);
    const std::vector<Law> laws = all_laws(random);
    for (int n = 0; n < 200; ++n) {
        std::vector<Law> some;
        for (int i = 0; i < 5; ++i) {
            const Law& law = laws[random.integer(0, static_cast<int>(laws.size()) - 1)];
            some.insert(some.end(), random.coin() ? 1 : 2, law);
        }
        const Model model = robot(some);
        std::stable_sort(some.begin(), some.end(),
                         [](const Law& a, const Law& b) { return a.kind < b.kind; });
        const Motion m = random_motion(random);
        Values expected = values_of(robot({}), m);
        for (const Law& law : some) expect(law, m, expected);
        check_near(values_of(model, m), expected);
    }
}

TEST_CASE("laws: in a pack of others a run has the bits that it has alone") {
    using Two = Pack<2>;
    Random random(3);
    const std::vector<Law> laws = all_laws(random);
    const auto draw = [&] {
        std::vector<Law> some;
        for (int i = random.integer(0, 3); i > 0; --i) {
            some.push_back(laws[random.integer(0, static_cast<int>(laws.size()) - 1)]);
        }
        return LawSet(some);
    };
    for (int n = 0; n < 500; ++n) {
        const std::array<LawSet, 2> sets = {draw(), draw()};
        LawTable table;
        REQUIRE(table.merge(sets[0].table()));
        REQUIRE(table.merge(sets[1].table()));
        CHECK(table.holds(sets[0].table()));
        std::vector<Two> numbers(table.numbers());
        LawInput<Two> at;
        LawMoment<Two> now;
        std::array<LawInput<double>, 2> ats;
        std::array<LawMoment<double>, 2> nows;
        for (int i = 0; i < 2; ++i) {
            const auto u = static_cast<std::size_t>(i);
            sets[u].spread(table, [&](std::size_t k, double number) { numbers[k].v[i] = number; });
            const Motion m = random_motion(random);
            ats[u] = {
                0.3,         {std::cos(m.angle), std::sin(m.angle), 0.0, 0.0, 0.0, 0.0, m.angle},
                m.slip_sign, m.slip * m.slip,
                m.x,         m.normal,
                m.vx * m.vx, m.omega};
            nows[u] = {m.quadrant * kQuarterTurn, 0.6, 0.8, m.age, m.time};
            const auto put = [i](Two& to, const double& from) { to.v[i] = from; };
            visit_numbers(put, now, nows[u]);
            const LawInput<double>& from = ats[u];
            at.tau.v[i] = from.tau;
            at.pose.cosine.v[i] = from.pose.cosine;
            at.pose.sine.v[i] = from.pose.sine;
            at.pose.angle.v[i] = from.pose.angle;
            at.slip_sign.v[i] = from.slip_sign;
            at.slip_speed.v[i] = from.slip_speed;
            at.place.v[i] = from.place;
            at.load.v[i] = from.load;
            at.speed_squared.v[i] = from.speed_squared;
            at.rate.v[i] = from.rate;
        }
        const Laws<Two> both(table, numbers.data(), now);
        std::array<Two, 1> friction = {0.7};
        both.apply<Quantity::sliding_friction, Quantity::friction_by_load>(at, friction);
        std::array<Two, 4> forces = {0.5, 0.9, 0.3, 1.0};
        both.apply<Quantity::adhesion, Quantity::fluid>(at, forces);
        for (std::size_t i = 0; i < 2; ++i) {
            const Laws<double> alone(sets[i].table(), sets[i].numbers(), nows[i]);
            std::array<double, 1> own = {0.7};
            alone.apply<Quantity::sliding_friction, Quantity::friction_by_load>(ats[i], own);
            CHECK(friction[0].v[i] == own[0]);
            std::array<double, 4> apart = {0.5, 0.9, 0.3, 1.0};
            alone.apply<Quantity::adhesion, Quantity::fluid>(ats[i], apart);
            for (std::size_t k = 0; k < 4; ++k) CHECK(forces[k].v[i] == apart[k]);
        }
    }
}

TEST_CASE("laws: the named kinds unfolded have the bits of any others") {
    Random random(4);
    std::vector<Law> named;
    for (const LawKind& kind : kNamedKinds) named.push_back(*law_of(kind, random));
    std::vector<Law> all = named;
    all.push_back(*law_of({Quantity::friction, Acts::adds, Argument::time, Form::wave}, random));
    all.back().amplitude = 0.0;
    const Model a = robot(named), b = robot(all);
    CHECK(a.laws.table().only_named);
    CHECK_FALSE(b.laws.table().only_named);
    for (int n = 0; n < 100; ++n) {
        const Motion m = random_motion(random);
        const Values own = values_of(a, m), other = values_of(b, m);
        CHECK(own.sticks == other.sticks);
        CHECK(own.slips == other.slips);
        CHECK(own.adhesion == other.adhesion);
        CHECK(own.drag == other.drag);
        CHECK(own.rotational_drag == other.rotational_drag);
    }
}

TEST_CASE("laws: a bound from below") {
    Random random(5);
    for (const Law& law : all_laws(random)) {
        if (law.kind.quantity != Quantity::drag) continue;
        const Model model = robot({law});
        const double least =
            model.laws.lowest(Quantity::drag, Quantity::drag, model.translational_drag);
        for (int n = 0; n < 50; ++n) {
            const double drag = values_of(model, random_motion(random)).drag;
            // A curve is bounded by its knots, which it passes a little.
            const double room = law.kind.form == Form::curve ? 0.5 : 1e-12;
            CHECK(std::max(drag, 0.0) >= least - room);
        }
    }
    CHECK(LawSet({Law{{Quantity::drag, Acts::adds, Argument::cosine, Form::square}, -0.3}})
              .lowest(Quantity::drag, Quantity::drag, 1.0) == 0.7);
}

TEST_CASE("laws: a table has an end") {
    LawTable table, many;
    for (std::size_t n = 0; n < LawTable::kMost; ++n) {
        many.kinds[many.count++] = {Quantity::drag, Acts::adds, Argument::time, Form::line,
                                    static_cast<unsigned char>(n)};
    }
    CHECK_FALSE(table.merge(many, 2 * LawTable::kMost - 1));
    CHECK(table.count == 0);
    CHECK(table.merge(many, 2 * LawTable::kMost));
    LawTable one;
    one.kinds[one.count++] = kNamedKinds[0];
    CHECK_FALSE(table.merge(one));
    CHECK(table.holds(many));
    CHECK_FALSE(table.holds(one));
    std::vector<Law> laws(LawTable::kMost + 1, {kNamedKinds[0]});
    CHECK_THROWS_AS(LawSet{laws}, std::invalid_argument);
}
