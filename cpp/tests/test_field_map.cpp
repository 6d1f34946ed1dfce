#include "stickslip/field_map.hpp"

#include <doctest/doctest.h>
