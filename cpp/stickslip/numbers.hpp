#pragma once

#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/free_curve.hpp"
#include "stickslip/numbers/hash.hpp"
#include "stickslip/numbers/number_text.hpp"
#include "stickslip/numbers/pack.hpp"
#include "stickslip/numbers/roots.hpp"
#include "stickslip/numbers/rows.hpp"

/// Numbers without robots.
///
/// - pack: several numbers that are added and multiplied at once, one a run
/// - elementary: exp, log, sine and cosine with the same bits for a double and for a pack
/// - roots: roots and least values of functions of one number
/// - free_curve: a curve through knots, for laws of another shape
/// - number_text: numbers as an error message shows them; hash: FNV-1a
/// - rows: tables of words and of what they mean
namespace stickslip {}
