#include <pybind11/numpy.h>

#include <stdexcept>
#include <vector>

#include "register.hpp"
#include "stickslip/corner_balance.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// points (g, 6): t, x, z, theta, contact age, slip. motions (rows, g, 5): theta, omega, alpha, vx,
/// ax. Columns by name, shape (rows, g), and the two scales.
py::dict balances(const Scenario& scenario, const Array& points, const Array& motions) {
    if (points.ndim() != 2 || points.shape(1) != 6 || motions.ndim() != 3 ||
        motions.shape(1) != points.shape(0) || motions.shape(2) != 5) {
        throw std::invalid_argument("points must be (g, 6) and motions (rows, g, 5)");
    }
    std::vector<BalancePoint> places;
    const auto p = points.unchecked<2>();
    for (py::ssize_t i = 0; i < p.shape(0); ++i) {
        places.push_back({p(i, 0), p(i, 1), p(i, 2), p(i, 3), p(i, 4), p(i, 5) < 0.0 ? -1 : 1});
    }
    std::vector<CornerMotion> moving;
    const auto m = motions.unchecked<3>();
    for (py::ssize_t row = 0; row < m.shape(0); ++row) {
        for (py::ssize_t i = 0; i < m.shape(1); ++i) {
            moving.push_back(
                {m(row, i, 0), m(row, i, 1), m(row, i, 2), m(row, i, 3), m(row, i, 4)});
        }
    }
    CornerBalances found;
    {
        const py::gil_scoped_release release;
        found = corner_balances(scenario, places, moving);
    }
    py::dict result;
    const auto add = [&](const char* name, double CornerBalance::*member) {
        Array column({m.shape(0), m.shape(1)});
        double* out = column.mutable_data();
        for (std::size_t i = 0; i < found.rows.size(); ++i) out[i] = found.rows[i].*member;
        result[name] = column;
    };
    add("torque", &CornerBalance::torque);
    add("force", &CornerBalance::force);
    add("friction_ratio", &CornerBalance::friction_ratio);
    add("contact_velocity", &CornerBalance::contact_velocity);
    result["torque_scale"] = found.torque_scale;
    result["weight"] = found.weight;
    return result;
}

}  // namespace

void register_balance(py::module_& module) {
    module.def("corner_balances", &balances, py::arg("scenario"), py::arg("points"),
               py::arg("motions"));
}

}  // namespace stickslip::bindings
