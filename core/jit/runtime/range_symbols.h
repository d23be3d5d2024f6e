/* The range domain's own symbols, besides an r_ form of every library function (symbols.inc). All parameters are
 * pointers, the result first, as elsewhere (runtime.cpp). In the bitcode for W lanes, with F a vector of W floats, I of
 * W int32:
 *
 *   range float  struct { F lo, hi; I nan; F centre, slope[3], rest; }   nan: all ones in lanes where the value may be
 *                NaN; ends are never NaN; the others: a line over the box (range_form.h)
 *   range int    struct { I lo, hi; }
 *   truth        struct { I mayTrue, mayFalse; }   masks; at least one is set in every lane
 *   triple       struct { range float x, y, z; }, matrix: struct { range float m[16]; }
 *
 * Letters: f range float, i range int, t truth, k mask (I). Triples and matrices are taken apart by the caller, except
 * in the library functions. A uniform operand is broadcast: lo = hi, nan = 0 (or its own isnan).
 *
 *   r_add_ff r_sub_ff r_mul_ff r_div_ff r_mod_ff   float: x / 0 and x % 0 are 0 (r_mod_ff is the % operator: fmod)
 *   r_neg_f
 *   r_add_ii r_sub_ii r_mul_ii r_div_ii r_mod_ii   int: everything where it may wrap; x / 0 and x % 0 are 0
 *   r_neg_i r_not_i                                -x, ~x
 *   r_and_ii r_or_ii r_xor_ii r_shl_ii r_shr_ii    bitwise; exact for single values, else a bound (shift counts modulo
 * 32) r_lt_ff r_le_ff r_gt_ff r_ge_ff r_eq_ff r_ne_ff   truth(f, f); the same with _ii r_truth_i       truth of an int:
 * may it be non-zero, may it be zero        (truth*, range int*) r_truth_f       the same of a float (NaN is not zero)
 *   r_int_t         truth as the int 0 or 1                                    (range int*, truth*)
 *   r_and_tt r_or_tt r_not_t                       logic of truths
 *   r_select_tff r_select_tii                      (result*, truth*, a*, b*): a where it may be true, b where it may be
 *                                                  false, both joined where undecided
 *   r_select_kff r_select_kii                      by a mask: a where set, else b. This is assignment under a mask
 *   r_between_ff                                   the range of two ends, each F
 *   r_join_ff r_join_ii                            hull of both
 *   r_meet_ff                                      what both hold; the first where they have nothing in common
 *   r_assign_kkff r_assign_kkii   (result*, must*, may*, new*, old*): assignment under control flow: `must` lanes
 * surely run it: new; lanes in `may` only: hull of new and old; the others: old r_toFloat_i (range float*, range int*)
 * r_toInt_f (range int*, range float*)
 */
#ifndef AEROSOL_RUNTIME_RANGE_SYMBOLS_H
#define AEROSOL_RUNTIME_RANGE_SYMBOLS_H
#endif
