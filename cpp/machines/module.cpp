#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "machines/heat.hpp"
#include "machines/motion.hpp"
#include "machines/path.hpp"
#include "machines/servo.hpp"

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

/// States at the readings, shape (vectors, readings, states). terms: (vectors, terms), in the order
/// of their names; start: (vectors, starts); times: (readings,); see signals_of.
template <class Machine>
Array states_of(const Array& terms, const Array& start, const Array& times, const Array& knots,
                const Array& inputs, const Array& late, bool lines) {
    constexpr py::ssize_t kTerms = Machine::kTerms.size(), kStarts = Machine::kStarts;
    const py::ssize_t vectors = terms.shape(0), readings = times.shape(0);
    require(terms.ndim() == 2 && terms.shape(1) == kTerms && start.ndim() == 2 &&
                start.shape(0) == vectors && start.shape(1) == kStarts &&
                fit(vectors, Machine::kInputs, knots, inputs, late),
            "states: the shapes do not fit");
    Array result({vectors, readings, py::ssize_t{Machine::kStates}});
    const std::span t(times.data(), static_cast<std::size_t>(readings));
    require(std::ranges::all_of(t, [](double x) { return std::isfinite(x); }), "a time not finite");
    const py::gil_scoped_release release;
    const double step = usual_step(t);
    for (py::ssize_t k = 0; k < vectors; ++k) {
        typename Machine::Terms own;
        const double* each = terms.data(k);
        for (const auto& term : Machine::kTerms) own.*term.value = *each++;
        auto acting = signals_of<Machine::kInputs>(k, knots, inputs, late, lines);
        acting.step = step;
        Machine::write(own, start.data(k), t, acting, result.mutable_data(k));
    }
    return result;
}

template <class Machine>
void add(py::module_& module, const char* name) {
    py::list names;
    for (const auto& each : Machine::kTerms) names.append(each.name);
    py::dict(module.attr("terms"))[name] = py::tuple(names);
    py::dict(module.attr("states"))[name] = py::cpp_function(&states_of<Machine>);
}

}  // namespace
}  // namespace machines

// Without the GIL its functions are safe side by side: they share nothing.
PYBIND11_MODULE(_machines, module, py::mod_gil_not_used()) {
    using namespace machines;
    module.doc() = "Motions of machines and heaters; the public interface is `stickslip.models`.";
    module.attr("terms") = py::dict();
    module.attr("states") = py::dict();
    add<Motion>(module, "motion");
    add<Heat>(module, "heat");
    add<ServoStates>(module, "servo");
}
