#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "stickslip/field/coil_set.hpp"

namespace stickslip::test {

/// The corners of a box of so many equal cells each way.
inline std::vector<Eigen::Vector3d> grid(const Box& box, int cells) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells; ++j) {
            for (int k = 0; k <= cells; ++k) {
                const Eigen::Vector3d part = Eigen::Vector3d(i, j, k) / cells;
                points.push_back(box.low + part.cwiseProduct(box.high - box.low));
            }
        }
    }
    return points;
}

/// The map of some coils as measured in a box without noise, with harmonics up to a degree.
inline std::shared_ptr<const FieldMap> fitted_map(const CoilSet& coils, const Box& box,
                                                  std::size_t degree) {
    const std::vector<Eigen::Vector3d> points = grid(box, 8);
    const auto rows = static_cast<Eigen::Index>(3 * points.size());
    const auto columns = static_cast<Eigen::Index>(FieldMap::count(degree));
    const std::vector<double> flat = harmonic_fields(box, degree, points);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        design(flat.data(), rows, columns);
    const Eigen::VectorXd scale = design.colwise().norm();
    const Eigen::HouseholderQR<Eigen::MatrixXd> factors(design * scale.cwiseInverse().asDiagonal());
    PerCoilOf<std::vector<double>> coefficients;
    for (const Coil coil : kAllCoils) {
        Eigen::VectorXd measured(rows);
        for (std::size_t i = 0; i < points.size(); ++i) {
            measured.segment<3>(static_cast<Eigen::Index>(3 * i)) =
                coils.unit_field(coil, points[i]).field;
        }
        const Eigen::VectorXd solution = factors.solve(measured).cwiseQuotient(scale);
        coefficients[static_cast<std::size_t>(coil)].assign(solution.begin(), solution.end());
    }
    return std::make_shared<const FieldMap>(box, coefficients);
}

/// Map of the coils of Table I in a box of 8 mm x 4 mm x 4 mm.
inline std::shared_ptr<const FieldMap> paper_map() {
    static const std::shared_ptr<const FieldMap> map =
        fitted_map(CoilSet(), {{-0.004, -0.002, -0.002}, {0.004, 0.002, 0.002}}, 6);
    return map;
}

}  // namespace stickslip::test
