// A fixed measure of speed: the motion of one robot, and nothing else.
//
// This program is written once and not changed. Figures of the product are ratios to it, so that
// machines, compilers and versions can be compared; a ratio to a moving measure says nothing. It
// has the physics of a run of the product with square coils, one plane, no effects and no
// restitution, and none of the product's services: no record, no summary but the way, no packs, no
// refusals. So it shows what these cost.
//
// What makes it fast: cosine and sine of the tilt are states; forces are accelerations; the field
// about a point half a step ahead has eight numbers, made once a step for the times of all stages;
// one comparison a step decides whether any event function needs a closer look.
//
// Standard input has lines `key value` with keys of a scenario, and lines `run rtol repeats`, each
// of which answers with a line of JSON. No key has a default.

#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));

// Truncated power series in (x, z), to third order -----------------------------------------------

constexpr int kTerms = 10;  // 1; x, z; xx, xz, zz; xxx, xxz, xzz, zzz

constexpr int term(int i, int j) {
    return (i + j) * (i + j + 1) / 2 + j;
}

struct Series {
    std::array<double, kTerms> a = {};

    Series() = default;
    Series(double value) { a[0] = value; }

    friend Series operator+(Series s, const Series& t) {
        for (int n = 0; n < kTerms; ++n) s.a[n] += t.a[n];
        return s;
    }
    friend Series operator-(Series s, const Series& t) {
        for (int n = 0; n < kTerms; ++n) s.a[n] -= t.a[n];
        return s;
    }
    [[gnu::noinline]] friend Series operator*(const Series& s, const Series& t) {
        Series product;
#pragma GCC unroll 4
        for (int i = 0; i <= 3; ++i) {
#pragma GCC unroll 4
            for (int j = 0; i + j <= 3; ++j) {
#pragma GCC unroll 4
                for (int k = 0; i + j + k <= 3; ++k) {
#pragma GCC unroll 4
                    for (int l = 0; i + j + k + l <= 3; ++l) {
                        product.a[term(i + k, j + l)] += s.a[term(i, j)] * t.a[term(k, l)];
                    }
                }
            }
        }
        return product;
    }
    // Of a function with these Taylor coefficients at a[0].
    Series of(double f0, double f1, double f2, double f3) const {
        Series rest = *this;
        rest.a[0] = 0.0;
        return Series(f0) + rest * (Series(f1) + rest * (Series(f2) + rest * Series(f3)));
    }
    Series inverse() const {
        const double r = 1.0 / a[0];
        return of(r, -r * r, r * r * r, -r * r * r * r);
    }
    Series root() const {
        const double s = std::sqrt(a[0]), r = 1.0 / a[0];
        return of(s, 0.5 * s * r, -0.125 * s * r * r, 0.0625 * s * r * r * r);
    }
};

// What is given -----------------------------------------------------------------------------------

struct Given {
    std::map<std::string, std::string> values;

    const std::string& word(const std::string& key) const {
        const auto found = values.find(key);
        if (found == values.end()) throw std::runtime_error("missing: " + key);
        return found->second;
    }
    double number(const std::string& key) const { return std::stod(word(key)); }
};

// Forces over the mass, torques over it too: N/kg and N m/kg.
struct Robot {
    double half_length, half_height, arm, inertia;  // m, m, m, m^2
    double stick, slip;                             // friction
    double adhesion, weight, drag, turning_drag, moment;

    explicit Robot(const Given& g) {
        const double length = g.number("robot.length"), height = g.number("robot.height");
        const double mass = g.number("robot.mass");
        half_length = 0.5 * length;
        half_height = 0.5 * height;
        arm = std::hypot(half_length, half_height);
        inertia = (length * length + height * height) / 12.0;
        stick = g.number("contact.static_friction");
        slip = g.number("contact.kinetic_friction");
        adhesion = g.number("contact.adhesion") / mass;
        weight = g.number("environment.gravity");
        drag = g.number("drag.linear") / mass;
        turning_drag = g.number("drag.rotational") / mass;
        moment = length * g.number("robot.width") * height * g.number("robot.magnetization") / mass;
    }
    double pinned_inertia() const { return inertia + arm * arm; }
};

// Two coils ---------------------------------------------------------------------------------------

// Moment over mass times Bx, Bz, dBx/dx, dBx/dz, dBz/dz, and the derivatives of the third to fifth
// along x: of one ampere, or of the currents at a time.
using Field = Eight;

struct Coils {
    double side, distance, strength;

    explicit Coils(const Given& g)
        : side(g.number("coil.side")),
          distance(g.number("coil.distance")),
          strength(1e-7 * g.number("coil.turns")) {}

    // Field along the coil's axis and across, at u along its axis from its plane, w across. A side
    // of the square is a wire from -a to a with the field G (e x rho), with e along the wire, rho
    // from its line and G = ((t + a)/R1 - (t - a)/R2) / rho^2. In the plane of symmetry the two
    // sides that cross it have t = 0, and the other two the same G.
    std::array<Series, 2> field(const Series& u, const Series& w) const {
        const double a = 0.5 * side;
        const auto crossing = [&](const Series& beside) {
            const Series square = u * u + beside * beside;
            return Series(2.0 * a) * (square * (square + Series(a * a)).root()).inverse();
        };
        const Series above = w - Series(a), below = w + Series(a);
        const Series g_above = crossing(above), g_below = crossing(below);
        const Series square = u * u + Series(a * a);
        const Series along = (below * (square + below * below).root().inverse() -
                              above * (square + above * above).root().inverse()) *
                             square.inverse();
        const Series k(strength);
        return {k * (Series(2.0 * a) * along + below * g_below - above * g_above),
                k * (u * (g_above - g_below))};
    }
    double centre_field() const { return field(Series(-distance), Series(0.0))[0].a[0]; }

    using Far = std::array<std::array<Field, kTerms>, 2>;
    // Both coils about (x, z), each term times `scale`: the one ahead, at +x, and the one below.
    Far expand(double x, double z, double scale) const {
        Series at_x(x), at_z(z);
        at_x.a[1] = 1.0;
        at_z.a[2] = 1.0;
        const auto ahead = field(at_x - Series(distance), at_z);
        const auto under = field(at_z + Series(distance), at_x);
        return {terms(ahead[0], ahead[1], scale), terms(under[1], under[0], scale)};
    }

private:
    // Row n: what term n of the place adds to the eight numbers.
    static std::array<Field, kTerms> terms(const Series& bx, const Series& bz, double scale) {
        std::array<Field, kTerms> rows = {};
        for (int i = 0; i <= 3; ++i) {
            for (int j = 0; i + j <= 3; ++j) {
                const int n = term(i, j);
                rows[n][0] = scale * bx.a[n];
                rows[n][1] = scale * bz.a[n];
                if (i + j == 3) continue;
                rows[n][2] = scale * (i + 1) * bx.a[term(i + 1, j)];
                rows[n][3] = scale * (j + 1) * bx.a[term(i, j + 1)];
                rows[n][4] = scale * (j + 1) * bz.a[term(i, j + 1)];
                if (i + j == 2) continue;
                rows[n][5] = scale * (i + 2) * (i + 1) * bx.a[term(i + 2, j)];
                rows[n][6] = scale * (i + 1) * (j + 1) * bx.a[term(i + 1, j + 1)];
                rows[n][7] = scale * (j + 2) * (j + 1) * bx.a[term(i, j + 2)];
            }
        }
        return rows;
    }
};

// a + b t + c exp(-t / T), A.
struct Current {
    double a, b, c;
    double at(double t, double e) const { return a + b * t + c * e; }
};

// Voltages of both coils at the ends of a segment.
struct Segment {
    double duration;  // s
    std::array<double, 2> from, to;
};

struct Drive {
    std::vector<Segment> segments;
    std::size_t third_pulse = 0;  // segments up to its end
    double window = 0.0;          // s, from there to the end
    double strongest;             // T

    Drive(const Given& g, const Coils& coils) {
        const double volts = g.number("coil.resistance") / coils.centre_field();
        const double base = volts * g.number("drive.base"), peak = volts * g.number("drive.peak");
        const double hold = volts * g.number("drive.hold"), ramp = g.number("drive.ramp");
        const double down = g.word("drive.clamp") == "down" ? -1.0 : 1.0;
        const bool in_plane = g.word("drive.mode") == "IPP";
        const bool rise = g.word("drive.edge") == "rise";
        const double period = 1.0 / g.number("drive.frequency");
        const auto pulses = static_cast<std::size_t>(g.number("drive.pulses"));
        const auto pair = [&](double pulsing) {
            return in_plane ? std::array{pulsing, down * hold} : std::array{hold, down * pulsing};
        };
        if (ramp > 0.0) segments.push_back({ramp, {0.0, 0.0}, pair(base)});
        third_pulse = segments.size() + 3;
        window = period * (static_cast<double>(pulses) - 3.0);
        const Segment pulse = {period, pair(rise ? peak : base), pair(rise ? base : peak)};
        segments.insert(segments.end(), pulses, pulse);
        strongest = std::hypot(g.number("drive.peak"), g.number("drive.hold"));
    }
};

// Where the body is -------------------------------------------------------------------------------

struct Body {
    double c = 1.0, s = 0.0, w = 0.0;  // cosine and sine of the tilt, its rate
    double x = 0.0, vx = 0.0, z = 0.0, vz = 0.0;

    void normalise() {
        const double factor = 1.0 / std::hypot(c, s);
        c *= factor;
        s *= factor;
    }
};

struct Load {
    double x, z, torque;
};

struct Sizes {
    double length, rate;
};

// Phases: states, rates, and four event functions that fall through zero. A corner has the side +1
// (front) or -1 (rear) and lies at (cx, -cz) from the centre of mass.
// Events: N, what they say, the gap of the other corner over the length.

struct Phase {
    const Robot& r;
    double side = 1.0, dir = 0.0;
    double px = 0.0;                // m, place of a sticking corner
    double at_x = 0.0, at_z = 0.0;  // m, centre of the field's eight numbers
    unsigned born = 0;              // event functions that are zero at the start

    double cx(double c, double s) const { return side * r.half_length * c - r.half_height * s; }
    double cz(double c, double s) const { return side * r.half_length * s + r.half_height * c; }

    [[gnu::always_inline]] Load load(const Field& f, double c, double s, double w, double x,
                                     double vx, double z, double vz) const {
        const double dx = x - at_x, dz = z - at_z;
        const double bx = f[0] + f[2] * dx + f[3] * dz, bz = f[1] + f[3] * dx + f[4] * dz;
        // Of the second derivatives only that of Bz along z is left out: the body moves little in
        // z.
        const double xx = f[2] + f[5] * dx + f[6] * dz, xz = f[3] + f[6] * dx + f[7] * dz;
        const double zz = f[4] + f[7] * dx;
        return {c * xx - s * xz - r.drag * vx, c * xz - s * zz - r.weight - r.drag * vz,
                -(s * bx + c * bz) - r.turning_drag * std::abs(w) * w};
    }
};

struct Stick : Phase {
    static constexpr int kDim = 3;  // c, s, w
    enum { kLeaves, kSlipsBack, kSlipsOn, kLands };
    using State = std::array<double, kDim>;

    static State scale(const Sizes& z) { return {1.0, 1.0, z.rate}; }
    State state(const Body& b) {
        px = b.x + cx(b.c, b.s);
        return {b.c, b.s, b.w};
    }
    Body body(const State& y) const {
        const double x = cx(y[0], y[1]), z = cz(y[0], y[1]);
        return {y[0], y[1], y[2], px - x, z * y[2], z, x * y[2]};
    }
    [[gnu::always_inline]] void rates(const Field& f, const State& y, State& dy, Four& g) const {
        const auto [c, s, w] = y;
        const double x = cx(c, s), z = cz(c, s), ww = w * w;
        const Load l = load(f, c, s, w, px - x, z * w, z, x * w);
        const double turn = (l.torque + z * l.x + x * l.z) * (1.0 / r.pinned_inertia());
        const double normal = x * turn - z * ww - l.z + r.adhesion;
        const double friction = z * turn + x * ww - l.x;
        dy = {-s * w, c * w, turn};
        g = Four{normal, r.stick * normal - friction, r.stick * normal + friction, side * s};
    }
};

struct Slip : Phase {
    static constexpr int kDim = 5;  // c, s, w, x, vx
    enum { kLeaves, kStops, kJams, kLands };
    using State = std::array<double, kDim>;

    static State scale(const Sizes& z) { return {1.0, 1.0, z.rate, z.length, z.length * z.rate}; }
    State state(const Body& b) const { return {b.c, b.s, b.w, b.x, b.vx}; }
    Body body(const State& y) const {
        const double z = cz(y[0], y[1]);
        return {y[0], y[1], y[2], y[3], y[4], z, cx(y[0], y[1]) * y[2]};
    }
    [[gnu::always_inline]] void rates(const Field& f, const State& y, State& dy, Four& g) const {
        const auto [c, s, w, place, vx] = y;
        const double x = cx(c, s), z = cz(c, s), ww = w * w;
        const Load l = load(f, c, s, w, place, vx, z, x * w);
        const double grip = r.slip * dir, lever = x - grip * z;
        const double moved = r.inertia + x * lever, pull = l.z - r.adhesion + z * ww;
        const double turn = (l.torque + x * r.adhesion + lever * pull) / moved;
        const double normal = x * turn - pull;
        dy = {-s * w, c * w, turn, vx, l.x - grip * normal};
        g = Four{normal, dir * (vx - z * w), moved, side * s};
    }
};

struct Flight : Phase {
    static constexpr int kDim = 7;  // c, s, w, x, vx, z, vz
    enum { kFrontLands, kRearLands };
    using State = std::array<double, kDim>;

    static State scale(const Sizes& z) {
        const double v = z.length * z.rate;
        return {1.0, 1.0, z.rate, z.length, v, z.length, v};
    }
    State state(const Body& b) const { return {b.c, b.s, b.w, b.x, b.vx, b.z, b.vz}; }
    Body body(const State& y) const { return {y[0], y[1], y[2], y[3], y[4], y[5], y[6]}; }
    [[gnu::always_inline]] void rates(const Field& f, const State& y, State& dy, Four& g) const {
        const auto [c, s, w, x, vx, z, vz] = y;
        const Load l = load(f, c, s, w, x, vx, z, vz);
        dy = {-s * w, c * w, l.torque * (1.0 / r.inertia), vx, l.x, vz, l.z};
        const double low = z - r.half_height * c, tip = r.half_length * s;
        g = Four{low - tip, low + tip, 1.0, 1.0};
    }
};

// A face that slides; at rest its last two events are the limits of friction.
struct Face : Phase {
    static constexpr int kDim = 2;  // x, vx
    enum { kFrontLifts, kRearLifts, kStops, kSlipsBack = kStops, kSlipsOn };
    using State = std::array<double, kDim>;

    static State scale(const Sizes& z) { return {z.length, z.length * z.rate}; }
    State state(const Body& b) const { return {b.x, b.vx}; }
    Body body(const State& y) const { return {1.0, 0.0, 0.0, y[0], y[1], r.half_height, 0.0}; }

    // Reactions of the front and rear corner under a friction force.
    [[gnu::always_inline]] std::array<double, 2> shares(const Load& l, double friction) const {
        const double lean = (l.torque - r.half_height * friction) / r.half_length;
        return {0.5 * (r.adhesion - l.z + lean), 0.5 * (r.adhesion - l.z - lean)};
    }
    [[gnu::always_inline]] void rates(const Field& f, const State& y, State& dy, Four& g) const {
        const Load l = load(f, 1.0, 0.0, 0.0, y[0], y[1], r.half_height, 0.0);
        const double friction = -r.slip * dir * (r.adhesion - l.z);
        const auto [front, rear] = shares(l, friction);
        dy = {y[1], l.x + friction};
        g = Four{front, rear, dir * y[1], 1.0};
    }
    Four at_rest(const Field& f, double x) const {
        const Load l = load(f, 1.0, 0.0, 0.0, x, 0.0, r.half_height, 0.0);
        const auto [front, rear] = shares(l, -l.x);  // friction holds the load
        const double most = r.stick * (r.adhesion - l.z);
        return Four{front, rear, most + l.x, most - l.x};
    }
};

// Root of a function that is positive at `low` and not at `high`: Chandrupatla (1997). The far end.
template <class Function>
double fall(double low, double high, double at_low, double at_high, double width, Function&& f) {
    // a is the last place, b the end on the other side.
    double a = low, b = high, fa = at_low, fb = at_high, t = fa / (fa - fb);
    while (std::abs(b - a) > width) {
        const double least = 0.5 * width / std::abs(b - a);
        t = std::clamp(t, least, 1.0 - least);
        const double x = a + t * (b - a), fx = f(x);
        double c, fc;
        if ((fx > 0.0) == (fa > 0.0)) {
            c = a, fc = fa;
        } else {
            c = b, fc = fb, b = a, fb = fa;
        }
        a = x, fa = fx;
        const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
        const bool smooth = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        t = smooth ? fa / (fb - fa) * fc / (fb - fc) +
                         (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
                   : 0.5;
    }
    return fa > 0.0 ? b : a;
}

// The pair 5(4) of Tsitouras (2011) ---------------------------------------------------------------

constexpr double kC[7] = {0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0, 1.0};
constexpr double kA[7][6] = {
    {},
    {0.161},
    {-0.008480655492356989, 0.335480655492357},
    {2.8971530571054935, -6.359448489975075, 4.3622954328695815},
    {5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525},
    {5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401,
     -0.028269050394068383},
    {0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
     2.324710524099774}};
constexpr double kError[7] = {-0.00178001105222577714,
                              -0.0008164344596567469,
                              0.007880878010261995,
                              -0.1447110071732629,
                              0.5823571654525552,
                              -0.45808210592918697,
                              1.0 / 66.0};

constexpr std::array<double, 7> dense_weights(double s) {
    const double ss = s * s;
    return {
        s * (1.0 + s * (-2.763706197274826 + s * (2.9132554618219126 - 1.0530884977290216 * s))),
        ss * (0.1317 + s * (-0.2234 + 0.1017 * s)),
        ss * (3.9302962368947516 + s * (-5.941033872131505 + 2.490627285651253 * s)),
        ss * (-12.411077166933676 + s * (30.33818863028232 - 16.548102889244902 * s)),
        ss * (37.50931341651104 + s * (-88.1789048947664 + 47.37952196281928 * s)),
        ss * (-27.896526289197286 + s * (65.09189467479366 - 34.87065786149661 * s)),
        ss * (1.5 + s * (-4.0 + 2.5 * s))};
}

// exp(-x) for 0 <= x <= 1/4, to 3e-13.
template <class Real>
[[gnu::always_inline]] inline Real decay(const Real& x) {
    Real sum = x * (-1.0 / 362880.0) + 1.0 / 40320.0;
    for (const double one :
         {-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5, -1.0, 1.0}) {
        sum = sum * x + one;
    }
    return sum;
}

struct Counts {
    std::int64_t evaluations = 0, steps = 0, events = 0;
};

// A run -------------------------------------------------------------------------------------------

class Run {
public:
    Counts counts;
    double x_third = 0.0, x_end = 0.0;

    Run(const Robot& robot, const Coils& coils, const Drive& drive, double time_constant,
        double resistance, double rtol)
        : r_(robot),
          coils_(coils),
          drive_(drive),
          time_constant_(time_constant),
          resistance_(resistance),
          rtol_(rtol),
          sizes_{robot.arm, std::sqrt((robot.moment * drive.strongest +
                                       (robot.weight + robot.adhesion) * robot.arm) /
                                      robot.pinned_inertia())} {}

    void play() {
        body_.z = r_.half_height;
        begin_segment();
        mode_ = {kRest, 0.0, 0.0, 0};
        while (!ended_) {
            switch (mode_.kind) {
                case kRest:
                    rest();
                    break;
                case kFace:
                    face();
                    break;
                case kStick:
                    stick();
                    break;
                case kSlip:
                    slip();
                    break;
                case kFlight:
                    flight();
                    break;
            }
            if (++counts.events > kMostEvents) throw std::runtime_error("too many events");
        }
        --counts.events;  // the end
        x_end = body_.x;
    }

private:
    enum Kind { kRest, kFace, kStick, kSlip, kFlight };
    struct Mode {
        Kind kind;
        double side, dir;
        unsigned born;
    };
    static constexpr double kReach = 150e-6;  // m, of the expansion of the field
    // First step of a phase times the rate of a free swing, and the factor of safety of the next
    // one: the best of some for the error of the place at equal evaluations.
    static constexpr double kFirst = 0.3, kSafety = 0.85;
    // Where events follow each other without time between them, a phase goes on for a shortest
    // step whatever they say.
    static constexpr double kShortest = 1e-9;  // s
    static constexpr int kMostIdle = 8;
    static constexpr int kEnd = -1;
    static constexpr std::int64_t kMostEvents = 10'000'000;

    const Robot& r_;
    const Coils& coils_;
    const Drive& drive_;
    const double time_constant_, resistance_, rtol_;
    const Sizes sizes_;

    Body body_;
    Mode mode_ = {};
    std::size_t segment_ = 0;
    bool ended_ = false;
    int idle_ = 0;
    double tau_ = 0.0, decayed_ = 1.0, tau_end_ = 0.0;
    std::array<Current, 2> current_ = {};
    Coils::Far far_ = {};
    double far_x_ = 1e9, far_z_ = 1e9;

    // Currents go on from where they are.
    void begin_segment() {
        const Segment& s = drive_.segments[segment_];
        for (std::size_t k = 0; k < 2; ++k) {
            const double now = segment_ ? current_[k].at(tau_, decayed_) : 0.0;
            const double slope = (s.to[k] - s.from[k]) / s.duration;
            const double a = (s.from[k] - time_constant_ * slope) / resistance_;
            current_[k] = {a, slope / resistance_, now - a};
        }
        tau_ = 0.0;
        decayed_ = 1.0;
        tau_end_ = s.duration;
    }
    void end_segment(double x) {
        tau_ = tau_end_;
        decayed_ = std::exp(-tau_end_ / time_constant_);
        if (++segment_ == drive_.third_pulse) x_third = x;
        ended_ = segment_ == drive_.segments.size();
        if (!ended_) begin_segment();
    }

    // Both coils' eight numbers about a place, per ampere.
    [[gnu::always_inline]] std::array<Field, 2> near(double x, double z) {
        if (std::abs(x - far_x_) > kReach || std::abs(z - far_z_) > kReach) {
            far_ = coils_.expand(x, z, r_.moment);
            far_x_ = x;
            far_z_ = z;
        }
        const double dx = x - far_x_, dz = z - far_z_;
        const double xx = dx * dx, xz = dx * dz, zz = dz * dz;
        const double power[kTerms] = {1.0, dx, dz, xx, xz, zz, xx * dx, xx * dz, zz * dx, zz * dz};
        std::array<Field, 2> sum;
        for (std::size_t k = 0; k < 2; ++k) {
            Field one = far_[k][0], two = far_[k][1] * power[1];
            for (int n = 2; n < kTerms; n += 2) one += far_[k][n] * power[n];
            for (int n = 3; n < kTerms; n += 2) two += far_[k][n] * power[n];
            sum[k] = one + two;
        }
        return sum;
    }
    Field field(const std::array<Field, 2>& unit, double t, double e) const {
        return unit[0] * current_[0].at(t, e) + unit[1] * current_[1].at(t, e);
    }
    template <class P>
    P phase() const {
        return P{{r_, mode_.side, mode_.dir, 0.0, 0.0, 0.0, mode_.born}};
    }
    // The field's eight numbers at the body now, with the phase told of their centre.
    template <class P>
    Field here(P& phase) {
        phase.at_x = body_.x;
        phase.at_z = body_.z;
        return field(near(body_.x, body_.z), tau_, decayed_);
    }

    // A step of one phase: the last attempt.
    template <class P>
    struct Step {
        using State = typename P::State;
        double h = 0.0;
        State y, end;
        State k[7];
        Four g[7];

        State dense(double s) const {
            const auto b = dense_weights(s);
            State at = y;
            for (int i = 0; i < P::kDim; ++i) {
                double sum = 0.0;
                for (int j = 0; j < 7; ++j) sum += b[j] * k[j][i];
                at[i] += h * sum;
            }
            return at;
        }
    };

    // From here to the first event, whose index it returns, or to the end of the drive.
    template <class P>
    int integrate(P& phase) {
        Step<P> step;
        step.y = phase.state(body_);
        const auto scale = P::scale(sizes_);
        std::array<double, P::kDim> weight;
        for (int i = 0; i < P::kDim; ++i) weight[i] = 1.0 / (rtol_ * scale[i]);
        phase.rates(here(phase), step.y, step.k[0], step.g[0]);
        ++counts.evaluations;
        bool stalled = idle_ > kMostIdle;
        for (int i = 0; i < 4 && !stalled; ++i) {
            if (!(phase.born >> i & 1) && step.g[0][i] <= 0.0) {
                ++idle_;
                return i;
            }
        }
        double next = stalled ? kShortest : kFirst / sizes_.rate;
        for (;;) {
            const Body from = phase.body(step.y);
            const double most = tau_end_ - tau_;
            const bool to_end = next * 1.0001 >= most;
            const double h = step.h = to_end ? most : next;
            if (!(tau_ + h > tau_)) throw std::runtime_error("the step became too short");
            // The field about the place of half a step ahead.
            phase.at_x = from.x + 0.5 * h * from.vx;
            phase.at_z = from.z + 0.5 * h * from.vz;
            const auto unit = near(phase.at_x, phase.at_z);
            const double error = attempt(phase, step, unit, weight);
            // An estimate of fifth order, and `error` is its square.
            const double factor = kSafety * shorter(error);
            if (!(error <= 1.0)) {
                next = h * (factor > 0.2 ? factor : 0.2);
                continue;
            }
            const Four low = least(step.g), high = most_of(step.g);
            const auto near_zero = (low < 0.35 * (high - low)) | (low <= 0.0);
            if (stalled) {
                phase.born = 0;
                idle_ = 0;
                stalled = false;
            } else if (phase.born || near_zero[0] | near_zero[1] | near_zero[2] | near_zero[3]) {
                double s = 1.0;
                const int hit = look(phase, step, unit, s);
                if (hit != kEnd) {
                    if (s > 0.0) ++counts.steps;
                    const auto at = s > 0.0 ? step.dense(s) : step.y;
                    decayed_ *= decay(s * h / time_constant_);
                    tau_ += s * h;
                    idle_ = s * h < kShortest ? idle_ + 1 : 0;
                    settle(phase.body(at));
                    return hit;
                }
            }
            ++counts.steps;
            step.y = step.end;
            step.k[0] = step.k[6];
            step.g[0] = step.g[6];
            next = std::max(to_end ? next : 0.0, h * std::min(factor, 5.0));
            next = std::min(next, 0.25 * time_constant_);
            if (!to_end) {
                tau_ += h;
                decayed_ *= decay(h / time_constant_);
                continue;
            }
            const Body now = phase.body(step.y);
            end_segment(now.x);
            if (ended_) {
                settle(now);
                return kEnd;
            }
        }
    }
    void settle(const Body& body) {
        body_ = body;
        body_.normalise();
        if (body_.c <= 0.0) throw std::runtime_error("the body stands on end");
    }

    template <class P>
    [[gnu::always_inline]] double attempt(const P& phase, Step<P>& step,
                                          const std::array<Field, 2>& unit,
                                          const std::array<double, P::kDim>& weight) {
        constexpr Eight kTimes = {kC[1], kC[2], kC[3], kC[4], kC[5], 0.0, 0.0, 0.0};
        const double h = step.h;
        const Eight t = kTimes * h;
        const Eight e = decayed_ * decay(Eight(t * (1.0 / time_constant_)));
        const Eight now = t + tau_;
        const Eight first = current_[0].a + current_[0].b * now + current_[0].c * e;
        const Eight second = current_[1].a + current_[1].b * now + current_[1].c * e;
        auto& k = step.k;
#pragma GCC unroll 6
        for (int n = 1; n < 7; ++n) {
            typename P::State y;
#pragma GCC unroll 7
            for (int i = 0; i < P::kDim; ++i) {
                double sum = kA[n][0] * k[0][i];
#pragma GCC unroll 6
                for (int j = 1; j < n; ++j) sum += kA[n][j] * k[j][i];
                y[i] = step.y[i] + h * sum;
            }
            const int at = n < 6 ? n - 1 : 4;
            phase.rates(Field(unit[0] * first[at] + unit[1] * second[at]), y, k[n], step.g[n]);
            if (n == 6) step.end = y;
        }
        counts.evaluations += 6;
        double total = 0.0;
#pragma GCC unroll 7
        for (int i = 0; i < P::kDim; ++i) {
            double sum = kError[0] * k[0][i];
#pragma GCC unroll 7
            for (int j = 1; j < 7; ++j) sum += kError[j] * k[j][i];
            sum *= h * weight[i];
            total += sum * sum;
        }
        return total * (1.0 / P::kDim);
    }

    // x^(-1/10) to some per cent, from the exponent of x: for the length of a step.
    static double shorter(double x) {
        std::int64_t bits;
        x = std::max(x, 1e-12);
        __builtin_memcpy(&bits, &x, sizeof x);
        constexpr std::int64_t one = std::int64_t{1023} << 52;
        bits = one - (bits - one) / 10;
        __builtin_memcpy(&x, &bits, sizeof x);
        return x;
    }
    static Four least(const Four (&g)[7]) {
        Four low = g[0];
        for (int n = 1; n < 7; ++n) low = g[n] < low ? g[n] : low;
        return low;
    }
    static Four most_of(const Four (&g)[7]) {
        Four high = g[0];
        for (int n = 1; n < 7; ++n) high = g[n] > high ? g[n] : high;
        return high;
    }

    // The first event of a step and its place; kEnd for none. Event functions that were born at
    // zero and have risen are no longer.
    template <class P>
    [[gnu::noinline]] int look(P& phase, const Step<P>& step, const std::array<Field, 2>& unit,
                               double& s) {
        int hit = kEnd;
        unsigned born = phase.born;
        for (int i = 0; i < 4; ++i) {
            const double first = step.g[0][i], last = step.g[6][i];
            const bool unborn = phase.born >> i & 1;
            const auto value = [&](double at) {
                ++counts.evaluations;
                const double e = decayed_ * decay(at * step.h / time_constant_);
                typename P::State unused;
                Four g;
                phase.rates(field(unit, tau_ + at * step.h, e), step.dense(at), unused, g);
                return g[i];
            };
            double low = 0.0, high = 1.0, at_low = first, at_high = last;
            if (unborn) {
                if (!rises(step, i, value, low, high, at_low, at_high)) {
                    s = 0.0;
                    return i;
                }
                born &= ~(1u << i);
                if (at_high > 0.0) continue;
            } else if (last > 0.0) {
                if (monotone(step, i)) continue;
                if (!dips(step, i, value, low, high, at_low, at_high)) continue;
            } else if (!monotone(step, i)) {
                for (const double at : {1.0 / 3.0, 2.0 / 3.0}) {
                    const double there = value(at);
                    if (there > 0.0) {
                        low = at, at_low = there;
                    } else {
                        high = at, at_high = there;
                        break;
                    }
                }
            }
            if (low >= s) continue;
            const double root = fall(low, high, at_low, at_high, 1e-11, value);
            if (hit == kEnd || root < s) hit = i, s = root;
        }
        phase.born = born;
        return hit;
    }
    // Rising, or falling, from stage to stage.
    template <class P>
    static bool monotone(const Step<P>& step, int i) {
        bool up = true, down = true;
        for (int n = 1; n < 7; ++n) {
            up &= step.g[n][i] >= step.g[n - 1][i];
            down &= step.g[n][i] <= step.g[n - 1][i];
        }
        return up || down;
    }
    // Zero at the start: does it rise from there? If it also falls again, from where and to.
    template <class P, class Value>
    static bool rises(const Step<P>& step, int i, Value&& value, double& low, double& high,
                      double& at_low, double& at_high) {
        bool all = true;
        for (int n = 1; n < 7; ++n) all &= step.g[n][i] > 0.0;
        if (all) return true;
        low = 0.0;
        for (const double at : {1.0 / 64.0, 0.25, 0.6, 1.0}) {
            const double there = at < 1.0 ? value(at) : step.g[6][i];
            if (there > 0.0) {
                low = at, at_low = there;
            } else if (low > 0.0) {
                high = at, at_high = there;
                return true;
            }
        }
        return low > 0.0;
    }
    // Positive at both ends: is it negative between? Not if the cubic through four stages keeps a
    // part of its range from zero; else samples, and golden section about the least.
    template <class P, class Value>
    static bool dips(const Step<P>& step, int i, Value&& value, double& low, double& high,
                     double& at_low, double& at_high) {
        constexpr double u = kC[1], v = kC[3];
        const double g0 = step.g[0][i], g1 = step.g[1][i], g3 = step.g[3][i], g6 = step.g[6][i];
        const double d1 = (g1 - g0) / u, d2 = (g3 - g1) / (v - u), d3 = (g6 - g3) / (1.0 - v);
        const double e1 = (d2 - d1) / v, e2 = (d3 - d2) / (1.0 - u), f = e2 - e1;
        double least = std::min(g0, g6), most = std::max(g0, g6);
        for (double t = 0.1; t < 0.95; t += 0.1) {
            const double g = g0 + t * (d1 + (t - u) * (e1 + (t - v) * f));
            least = std::min(least, g);
            most = std::max(most, g);
        }
        if (least > 0.1 * (most - least)) return false;

        constexpr int kSamples = 8;
        constexpr double kGolden = 0.3819660112501051;
        std::array<double, kSamples + 1> sample = {};
        sample[0] = g0;
        sample[kSamples] = g6;
        int lowest = g0 < g6 ? 0 : kSamples;
        const auto found = [&](double left, double at_left, double right, double at_right) {
            low = left, at_low = at_left, high = right, at_high = at_right;
            return true;
        };
        for (int n = 1; n < kSamples; ++n) {
            const double at = n * (1.0 / kSamples);
            sample[n] = value(at);
            if (sample[n] <= 0.0) return found(at - 1.0 / kSamples, sample[n - 1], at, sample[n]);
            if (sample[n] < sample[lowest]) lowest = n;
        }
        if (lowest == 0 || lowest == kSamples) return false;
        const double left = (lowest - 1) * (1.0 / kSamples), at_left = sample[lowest - 1];
        double a = left, at_a = at_left, b = left + 2.0 / kSamples, at_b = sample[lowest + 1];
        double m = left + 1.0 / kSamples, at_m = sample[lowest];
        // A parabola of this curvature falls below the least of three by a quarter of its sag.
        while (at_m < 0.25 * (at_a + at_b - 2.0 * at_m)) {
            const bool after = b - m > m - a;
            const double at = after ? m + kGolden * (b - m) : m - kGolden * (m - a);
            const double there = value(at);
            if (there <= 0.0) return found(left, at_left, at, there);
            if (there < at_m) {
                (after ? a : b) = m;
                (after ? at_a : at_b) = at_m;
                m = at, at_m = there;
            } else {
                (after ? b : a) = at;
                (after ? at_b : at_a) = there;
            }
        }
        return false;
    }

    // What follows an event ----------------------------------------------------------------------

    void rest() {
        Face face = phase<Face>();
        const std::array<Field, 2> unit = near(body_.x, body_.z);
        face.at_x = body_.x;
        face.at_z = body_.z;
        const Four none = face.at_rest(Field{}, body_.x);
        const Four one = face.at_rest(unit[0], body_.x) - none;
        const Four two = face.at_rest(unit[1], body_.x) - none;
        while (!ended_) {
            double first = tau_end_;
            int hit = kEnd;
            for (int i = 0; i < 4; ++i) {
                const Current sum = {none[i] + one[i] * current_[0].a + two[i] * current_[1].a,
                                     one[i] * current_[0].b + two[i] * current_[1].b,
                                     one[i] * current_[0].c + two[i] * current_[1].c};
                const auto value = [&](double t) {
                    return sum.at(t, std::exp(-t / time_constant_));
                };
                // One turn at most, at b = c / T exp(-t / T).
                double low = tau_, ends[2] = {tau_end_, tau_end_};
                const double turn = -time_constant_ * std::log(sum.b * time_constant_ / sum.c);
                if (turn > low && turn < tau_end_) ends[0] = turn;
                for (const double high : ends) {
                    const double there = value(high);
                    if (there <= 0.0) {
                        const double root = fall(low, high, value(low), there, 1e-13, value);
                        if (root < first) first = root, hit = i;
                        break;
                    }
                    low = high;
                }
            }
            if (hit == kEnd) {
                end_segment(body_.x);
                continue;
            }
            tau_ = first;
            decayed_ = std::exp(-first / time_constant_);
            if (hit == Face::kFrontLifts) return corner(-1.0, 0.0, true);
            if (hit == Face::kRearLifts) return corner(1.0, 0.0, true);
            return start_slide(hit == Face::kSlipsBack ? -1.0 : 1.0);
        }
    }

    void face() {
        Face phase = this->phase<Face>();
        switch (integrate(phase)) {
            case Face::kFrontLifts:
                return corner(-1.0, mode_.dir, true);
            case Face::kRearLifts:
                return corner(1.0, mode_.dir, true);
            case Face::kStops:
                return flat(0.0);
            default:
                return;
        }
    }
    void stick() {
        Stick phase = this->phase<Stick>();
        switch (integrate(phase)) {
            case Stick::kLeaves:
                return leave();
            case Stick::kSlipsBack:
                return start_slip(-1.0, phase.born);
            case Stick::kSlipsOn:
                return start_slip(1.0, phase.born);
            case Stick::kLands:
                return land_flat(true);
            default:
                return;
        }
    }
    void slip() {
        Slip phase = this->phase<Slip>();
        switch (integrate(phase)) {
            case Slip::kLeaves:
                return leave();
            case Slip::kStops:
                return corner(mode_.side, 0.0, phase.born >> Slip::kLands & 1);
            case Slip::kJams:
                throw std::runtime_error("the slip jams (Painleve)");
            case Slip::kLands:
                return land_flat(false);
            default:
                return;
        }
    }
    void flight() {
        Flight phase = this->phase<Flight>();
        const int hit = integrate(phase);
        if (hit != kEnd) land(hit == Flight::kFrontLands ? 1.0 : -1.0);
    }

    // A contact that lets go has a gap of zero; the other corner's is that of the tilt.
    void leave() {
        mode_ = {kFlight, 0.0, 0.0,
                 1u << (mode_.side > 0.0 ? Flight::kFrontLands : Flight::kRearLands)};
    }
    void start_slip(double dir, unsigned born) {
        mode_ = {kSlip, mode_.side, dir, 1u << Slip::kStops | (born & 1u << Slip::kLands)};
    }

    void start_slide(double dir) {
        mode_ = {kFace, 0.0, dir, 1u << Face::kStops};
    }

    // A corner touches, slips in a direction or (zero) has no slip velocity. `level`: the other
    // corner has just left the surface.
    void corner(double side, double dir, bool level) {
        mode_ = {kStick, side, dir, level ? 1u << Stick::kLands : 0u};
        if (dir != 0.0) {
            mode_.kind = kSlip;
            return;
        }
        Stick phase = this->phase<Stick>();
        const Field f = here(phase);
        Stick::State unused;
        Four g;
        const auto state = phase.state(body_);
        body_ = phase.body(state);
        phase.rates(f, state, unused, g);
        ++counts.evaluations;
        if (g[Stick::kLeaves] <= 0.0) return leave();
        if (g[Stick::kSlipsBack] <= 0.0) return start_slip(-1.0, mode_.born);
        if (g[Stick::kSlipsOn] <= 0.0) return start_slip(1.0, mode_.born);
    }

    // The bottom lies on the surface, slides in a direction or (zero) not.
    void flat(double dir) {
        body_ = {1.0, 0.0, 0.0, body_.x, dir == 0.0 ? 0.0 : body_.vx, r_.half_height, 0.0};
        mode_ = {kFace, 0.0, dir, 0};
        Face phase = this->phase<Face>();
        const Field f = here(phase);
        Four g;
        if (dir == 0.0) {
            g = phase.at_rest(f, body_.x);
        } else {
            Face::State unused;
            phase.rates(f, phase.state(body_), unused, g);
        }
        ++counts.evaluations;
        if (g[Face::kFrontLifts] <= 0.0) return corner(-1.0, dir, true);
        if (g[Face::kRearLifts] <= 0.0) return corner(1.0, dir, true);
        if (dir != 0.0) return;
        mode_.kind = kRest;
        for (const int i : {Face::kSlipsBack, Face::kSlipsOn}) {
            if (g[i] <= 0.0) start_slide(i == Face::kSlipsBack ? -1.0 : 1.0);
        }
    }

    static double sign_of(double x) {
        return x > 0.0 ? 1.0 : -1.0;
    }

    struct Impact {
        double dir, x, z, turn;  // final slip; changes of vx, vz, w
    };
    // Plastic, with Coulomb friction on the impulse.
    Impact impact(double side, double friction) const {
        Phase p{r_};
        p.side = side;
        const double x = p.cx(body_.c, body_.s), z = p.cz(body_.c, body_.s), j = 1.0 / r_.inertia;
        const double vt = body_.vx - z * body_.w, vn = body_.vz - x * body_.w;
        const double tt = 1.0 + z * z * j, nn = 1.0 + x * x * j, tn = x * z * j;
        const double d = tt * nn - tn * tn;
        double pt = (tn * vn - nn * vt) / d, pn = (tn * vt - tt * vn) / d, dir = 0.0;
        if (std::abs(pt) > friction * pn) {
            dir = -sign_of(pt);
            pn = -vn / (nn - friction * dir * tn);
            pt = -friction * dir * pn;
        }
        return {dir, pt, pn, -(z * pt + x * pn) * j};
    }
    void apply(const Impact& i) {
        body_.vx += i.x;
        body_.vz += i.z;
        body_.w += i.turn;
    }

    void land(double side) {
        const Impact found = impact(side, r_.slip);
        apply(found);
        corner(side, found.dir, false);
    }

    // The corner `side` has been on the surface, and the other one arrives.
    void land_flat(bool stuck) {
        const double side = mode_.side, hl = r_.half_length, hh = r_.half_height;
        body_ = {1.0, 0.0, body_.w, body_.x, body_.vx, hh, body_.vz};
        // Only the arriving corner takes an impulse, if the other one leaves.
        const Impact one = impact(-side, r_.slip);
        if (body_.vz + one.z - side * hl * (body_.w + one.turn) > 0.0) {
            apply(one);
            return corner(-side, one.dir, true);
        }
        // Both do: the body comes to lie. p + q = -vz, and what is left turns it.
        const double old = stuck ? r_.stick : r_.slip;
        const auto split = [&](double pt) {  // impulse of the old corner less that of the new one
            return side * (r_.inertia * body_.w - hh * pt) / hl;
        };
        const double sum = -body_.vz;
        const double stop = -body_.vx;
        const double most = 0.5 * ((old + r_.slip) * sum + (old - r_.slip) * split(stop));
        double dir = 0.0;
        if (std::abs(stop) > most) {
            dir = sign_of(body_.vx);
            // pt = -dir ((old + new) sum + (old - new) split(pt)) / 2, linear in pt.
            const double at_none = split(0.0), slope = -side * hh / hl;
            const double pt = -dir * 0.5 * ((old + r_.slip) * sum + (old - r_.slip) * at_none) /
                              (1.0 + dir * 0.5 * (old - r_.slip) * slope);
            body_.vx += pt;
        }
        flat(dir);
    }
};

double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void answer(const Given& g, double rtol, int repeats) {
    const Robot robot(g);
    const Coils coils(g);
    const Drive drive(g, coils);
    const double resistance = g.number("coil.resistance");
    const double time_constant = g.number("coil.inductance") / resistance;
    const auto played = [&] {
        Run run(robot, coils, drive, time_constant, resistance, rtol);
        run.play();
        return run;
    };
    const Run run = played();  // not counted
    std::vector<double> costs;
    for (int n = 0; n < repeats; ++n) {
        const double started = cpu_seconds();
        played();
        costs.push_back(cpu_seconds() - started);
    }
    std::nth_element(costs.begin(), costs.begin() + repeats / 2, costs.end());
    std::printf(
        "{\"rtol\": %g, \"cpu_seconds\": %.9g, \"evaluations\": %lld, \"steps\": %lld, "
        "\"events\": %lld, \"x\": %.17g, \"mean_velocity\": %.17g}\n",
        rtol, costs[static_cast<std::size_t>(repeats / 2)],
        static_cast<long long>(run.counts.evaluations), static_cast<long long>(run.counts.steps),
        static_cast<long long>(run.counts.events), run.x_end,
        (run.x_end - run.x_third) / drive.window);
    std::fflush(stdout);
}

}  // namespace

int main() {
    Given given;
    std::string key;
    try {
        while (std::cin >> key) {
            if (key == "run") {
                double rtol;
                int repeats;
                std::cin >> rtol >> repeats;
                answer(given, rtol, repeats);
            } else {
                std::cin >> given.values[key];
            }
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "limit: %s\n", error.what());
        return 1;
    }
    return 0;
}
