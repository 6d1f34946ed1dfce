#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "register.hpp"
#include "stickslip/drive/sawtooth.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_map.hpp"
#include "stickslip/readings/probe.hpp"

namespace stickslip::bindings {
namespace {

/// Calls visit(index, field_and_gradient) for each point, without the GIL.
template <class Visit>
void for_each_point(const CoilSet& coils, const Array& points, const Array& currents,
                    Visit&& visit) {
    const auto point = points.unchecked<2>();
    const auto current = currents.unchecked<2>();
    const py::ssize_t count = point.shape(0);
    if (point.shape(1) != 3 || current.shape(1) != kCoilCount ||
        (current.shape(0) != count && current.shape(0) != 1)) {
        throw std::invalid_argument("points must be (n, 3) and currents (n, 5) or (1, 5)");
    }
    const bool common = current.shape(0) == 1;

    const py::gil_scoped_release release;
    for (py::ssize_t i = 0; i < count; ++i) {
        const Eigen::Map<const Eigen::Vector3d> position(point.data(i, 0));
        const Eigen::Map<const Currents> amperes(current.data(common ? 0 : i, 0));
        visit(i, coils.field(position, amperes));
    }
}

/// Field (T) of all coils, shape (n, 3), at points (m) of shape (n, 3) for currents (A) of shape
/// (n, 5) or (1, 5). ValueError on the wire of a coil that has current, or outside of the set's
/// map; ScenarioError for other shapes.
Array field(const CoilSet& coils, const Array& points, const Array& currents) {
    Array result({points.shape(0), py::ssize_t{3}});
    auto out = result.mutable_unchecked<2>();
    for_each_point(coils, points, currents, [&out](py::ssize_t i, const FieldAndGradient& at) {
        for (py::ssize_t k = 0; k < 3; ++k) out(i, k) = at.field[k];
    });
    return result;
}

/// The gradient of the field (T/m) at the same points, [n, i, j] = dB_i / dx_j.
Array gradient(const CoilSet& coils, const Array& points, const Array& currents) {
    Array result({points.shape(0), py::ssize_t{3}, py::ssize_t{3}});
    auto out = result.mutable_unchecked<3>();
    for_each_point(coils, points, currents, [&out](py::ssize_t i, const FieldAndGradient& at) {
        for (py::ssize_t k = 0; k < 3; ++k)
            for (py::ssize_t l = 0; l < 3; ++l) out(i, k, l) = at.gradient(k, l);
    });
    return result;
}

/// One value a coil.
template <double CoilGeometry::*kMember>
PerCoil of_each(const CoilSet& coils) {
    PerCoil result;
    for (std::size_t k = 0; k < kCoilCount; ++k) result[k] = coils.geometry()[k].*kMember;
    return result;
}

/// Field of each coil by itself (T), shape (n, 5, 3); NaN where `field` refuses a point.
Array shares(const CoilSet& coils, const Array& points, const Array& currents) {
    const std::vector<double> found = coil_shares(coils, flat(points), flat(currents));
    Array result({points.shape(0), py::ssize_t{kCoilCount}, py::ssize_t{3}});
    std::copy(found.begin(), found.end(), result.mutable_data());
    return result;
}

/// What multiplies each coefficient (T/A) in the field per ampere, at points (m) of shape (n, 3),
/// for the box from `low` to `high` (m): shape (n, 3, harmonics), in the order C_10, C_11, S_11,
/// C_20, ... (see FieldMap).
Array fields_of_harmonics(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                          std::size_t degree, const Array& points) {
    if (points.ndim() != 2 || points.shape(1) != 3) {
        throw std::invalid_argument("points must be (n, 3)");
    }
    std::vector<Eigen::Vector3d> places;
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        places.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
    }
    const std::vector<double> found = harmonic_fields({low, high}, degree, places);
    Array result(
        {points.shape(0), py::ssize_t{3}, static_cast<py::ssize_t>(FieldMap::count(degree))});
    std::copy(found.begin(), found.end(), result.mutable_data());
    return result;
}

/// One component of the unit vectors of angles.
template <double SurfaceDirection::*kPart>
double direction_part(double angle) {
    return surface_direction(angle).*kPart;
}

}  // namespace

void register_field(py::module_& module) {
    py::class_<FieldMap>(module, "FieldMap", doc::FieldMap)
        .def(py::init([](const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         const PerCoilOf<std::vector<double>>& coefficients) {
                 return FieldMap({low, high}, coefficients);
             }),
             py::arg("low"), py::arg("high"), py::arg("coefficients"),
             "low, high: corners of the box (m). coefficients: T/A, of each coil, by harmonic "
             "(C_10, "
             "C_11, S_11, ...), of degree 1 to `most_map_degree`. ScenarioError for others.");
    module.def("harmonic_fields", &fields_of_harmonics, py::arg("low"), py::arg("high"),
               py::arg("degree"), py::arg("points"), doc::fields_of_harmonics);
    module.attr("most_map_degree") = FieldMap::kMostDegree;
    py::class_<CoilSet>(module, "CoilSet", doc::CoilSet)
        .def(py::init([](const PerCoil& side, const PerCoil& distance, const PerCoil& turns) {
                 PerCoilOf<CoilGeometry> geometry;
                 for (std::size_t k = 0; k < kCoilCount; ++k) {
                     geometry[k] = {side[k], distance[k], turns[k]};
                 }
                 return CoilSet(geometry);
             }),
             py::arg("side"), py::arg("distance"), py::arg("turns"),
             "Side and distance (m), and turns, of xp, xm, yp, ym, clamp.")
        .def_property_readonly("side", &of_each<&CoilGeometry::side>, doc::CoilGeometry_side)
        .def_property_readonly("distance", &of_each<&CoilGeometry::distance>,
                               doc::CoilGeometry_distance)
        .def_property_readonly("turns", &of_each<&CoilGeometry::turns>, "Number of turns.")
        .def_property_readonly("centre_field_per_ampere", &CoilSet::centre_fields_per_ampere,
                               doc::CoilSet_centre_field_per_ampere)
        .def("field", &field, py::arg("points"), py::arg("currents"), doc::field)
        .def("gradient", &gradient, py::arg("points"), py::arg("currents"), doc::gradient)
        .def_property_readonly(
            "box",
            [](const CoilSet& self) -> py::object {
                if (self.map() == nullptr) return py::none();
                const auto& [low, high] = self.map()->box();
                return py::make_tuple(low, high);
            },
            "Lowest and highest corner of the map (m); None without a map.")
        .def("shares", &shares, py::arg("points"), py::arg("currents"), doc::shares);
    module.def(
        "surface_directions",
        [](const Array& angles) {
            return py::make_tuple(py::vectorize(&direction_part<&SurfaceDirection::x>)(angles),
                                  py::vectorize(&direction_part<&SurfaceDirection::y>)(angles));
        },
        py::arg("angles"),
        "x and y of unit vectors in the surface at angles (rad) from +x, arrays of the shape of "
        "`angles`; exact at multiples of a quarter turn.");
    py::list coil_names;
    for (const Coil coil : kAllCoils) coil_names.append(name(coil));
    module.attr("coil_names") = py::tuple(coil_names);
    module.attr("wire_radius") = kWireRadius;
}

}  // namespace stickslip::bindings
