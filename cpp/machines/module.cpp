#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "machines/heat.hpp"
#include "machines/motion.hpp"
#include "machines/path.hpp"

namespace py = pybind11;

namespace machines {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

void require(bool fits, const char* what) {
    if (!fits) throw std::invalid_argument(what);
}

/// The inputs of one vector. knots: (1 or vectors, knots); inputs: (vectors, 1 + knots, inputs), at
/// first before the record; late: (vectors, inputs).
template <std::size_t N>
Signals<N> signals_of(py::ssize_t vector, const Array& knots, const Array& inputs,
                      const Array& late, bool lines) {
    Signals<N> result = {};
    const double* own = knots.data(knots.shape(0) > 1 ? vector : 0);
    result.knots = {own, static_cast<std::size_t>(knots.shape(1))};
    result.values = inputs.data(vector);
    std::copy_n(late.data(vector), N, result.late.begin());
    result.lines = lines;
    return result;
}

bool fit(py::ssize_t vectors, py::ssize_t count, const Array& knots, const Array& inputs,
         const Array& late) {
    return knots.ndim() == 2 && (knots.shape(0) == 1 || knots.shape(0) == vectors) &&
           inputs.ndim() == 3 && inputs.shape(0) == vectors &&
           inputs.shape(1) == 1 + knots.shape(1) && inputs.shape(2) == count && late.ndim() == 2 &&
           late.shape(0) == vectors && late.shape(1) == count;
}

/// States x, v, y, w at the readings, shape (vectors, readings, 4). terms: (vectors, terms);
/// start: (vectors, 2); times: (readings,); see signals_of.
Array moved(const Array& terms, const Array& start, const Array& times, const Array& knots,
            const Array& inputs, const Array& late, bool lines) {
    const py::ssize_t vectors = terms.shape(0), readings = times.shape(0);
    require(terms.ndim() == 2 && terms.shape(1) == py::ssize_t{kMotionTerms.size()} &&
                start.ndim() == 2 && start.shape(0) == vectors && start.shape(1) == 2 &&
                fit(vectors, 1, knots, inputs, late),
            "moved: the shapes do not fit");
    Array result({vectors, readings, py::ssize_t{4}});
    const std::span t(times.data(), static_cast<std::size_t>(readings));
    const py::gil_scoped_release release;
    for (py::ssize_t k = 0; k < vectors; ++k) {
        MotionTerms own;
        for (std::size_t i = 0; i < kMotionTerms.size(); ++i) {
            own.*kMotionTerms[i].value = terms.at(k, i);
        }
        const double x = start.at(k, 0), v = start.at(k, 1);
        double* out = result.mutable_data(k);
        const Signals<1> acting = signals_of<1>(k, knots, inputs, late, lines);
        if (own.gap != 0.0 || own.spring != 0.0) {
            follow(TwoMasses(own), {x, v, x, v}, t, acting, [&](std::size_t n, const auto& z) {
                std::copy(z.begin(), z.end(), out + 4 * n);
            });
        } else {
            follow(OneMass(own), {x, v}, t, acting, [&](std::size_t n, const auto& z) {
                for (std::size_t i = 0; i < 4; ++i) out[4 * n + i] = z[i % 2];
            });
        }
    }
    return result;
}

/// Temperatures of the body at the readings, shape (vectors, readings). terms: (vectors, 7);
/// start: (vectors,); times: (readings,); inputs: power and ambient, see signals_of.
Array heated(const Array& terms, const Array& start, const Array& times, const Array& knots,
             const Array& inputs, const Array& late, bool lines) {
    const py::ssize_t vectors = terms.shape(0), readings = times.shape(0);
    require(terms.ndim() == 2 && terms.shape(1) == 7 && start.shape(0) == vectors &&
                fit(vectors, 2, knots, inputs, late),
            "heated: the shapes do not fit");
    Array result({vectors, readings});
    const std::span t(times.data(), static_cast<std::size_t>(readings));
    const py::gil_scoped_release release;
    for (py::ssize_t k = 0; k < vectors; ++k) {
        const double* own = terms.data(k);
        const HeatTerms c{own[0], own[1], own[2], own[3], own[4], own[5], own[6]};
        const double begin = start.at(k);
        double* out = result.mutable_data(k);
        const Signals<2> acting = signals_of<2>(k, knots, inputs, late, lines);
        const auto write = [&](std::size_t n, const auto& z) { out[n] = z[0]; };
        if (c.heater > 0.0 && c.wall > 0.0) {
            follow(HeatStores<true, true>(c), {begin, begin, begin}, t, acting, write);
        } else if (c.heater > 0.0) {
            follow(HeatStores<true, false>(c), {begin, begin}, t, acting, write);
        } else if (c.wall > 0.0) {
            follow(HeatStores<false, true>(c), {begin, begin}, t, acting, write);
        } else {
            follow(HeatStores<false, false>(c), {begin}, t, acting, write);
        }
    }
    return result;
}

}  // namespace
}  // namespace machines

// Without the GIL its functions are safe side by side: they share nothing.
PYBIND11_MODULE(_machines, module, py::mod_gil_not_used()) {
    using namespace machines;
    module.doc() = "Motions of machines and heaters; the public interface is `stickslip.models`.";
    py::list names;
    for (const MotionTerm& each : kMotionTerms) names.append(each.name);
    module.attr("motion_terms") = py::tuple(names);
    module.def("moved", &moved, py::arg("terms"), py::arg("start"), py::arg("times"),
               py::arg("knots"), py::arg("inputs"), py::arg("late"), py::arg("lines"));
    module.def("heated", &heated, py::arg("terms"), py::arg("start"), py::arg("times"),
               py::arg("knots"), py::arg("inputs"), py::arg("late"), py::arg("lines"));
}
