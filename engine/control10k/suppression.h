// The adaptive suppression of resonances (thesis Sec. 5.5, Fig. 5.17) as a state machine, one step per sample.
//
//   IDLE     adaptation off: the bank stands still, no history; the filters keep filtering
//   COLLECT  samples 1 .. N - 1 of a block enter the Goertzel bank
//   DECIDE   sample N: the largest line f_x, eta_x is judged; the first rule that fails gives the outcome
//              kQuiet    1  eta_x > T_min                                                        (5.31)
//              kEdge     2  the largest line is no edge bin, f_min < f_x < f_max                 (5.33), (5.34)
//              kMixed    3  both neighbours lie on one Blackman lobe                             (5.35)
//              kMoving   4  the last N_s + 1 results f_x differ by less than epsilon in sum      (5.36)
//              kWeaker   5  eta_x >= min(eta)                                                    Sec. 5.5.5
//            else kPlaced: filter argmin(eta) (the lowest index of equal ones) takes f_x and eta_x
//   then COLLECT again. Between placements eta fades, (5.37).
//
// Decided here, where the thesis is silent or a print cannot work:
// - f_x enters the history whenever the largest line has two neighbours; an edge bin has no f_x and clears the history.
// - The history is cleared after a placement: the oscillation takes longer than a block to die, and the next result
//   would put the next filter on the same frequency.
// - N_s = 10 differences need 11 results.
// - Condition 3 with 5 % on both neighbours rejects a clean tone that lies beyond 0.445 bins: there the Gaussian (5.28)
//   misses the neighbour that is further away by up to 5.7 %. That neighbour has a tolerance of its own.
// - (5.37) decays eta, at every sample. alpha = 1 - 1e-9 is 1 in single precision: this core counts in double.
//
// Probing (Appendix E), off by default: instead of being placed, a frequency that passes all rules is given to a spare
// filter whose pole radius shrinks from 1 by gamma at each block. The frequency of an oscillation of the loop must move
// with it (the phase at that frequency changed); a load's does not.
//   PROBE    after each block:
//            the line has vanished, or left f_x for good  -> the filter stays: kPlaced
//            it moved by at least probe_shift since the
//            radius last changed                          -> smaller radius, down to `radius`: kPlaced
//            it did not, `probe_patience` blocks long     -> radius back to 1 (E.1): kRefused
// The reaction is not one new frequency: a filter that hits the oscillation splits its mode into two beside it (at 832
// Hz and r = 0.9995 into 829.3 and 834.2 Hz, both growing more slowly), and the estimate wavers with their beat by some
// tenths of a hertz. A load's tone keeps its frequency to some hundredths. Hence 0.1 Hz.
// (E.1) as printed, min(1, max(r - gamma, r_min)), cannot give a filter back: gamma >= 0 never lets r rise.
#pragma once

#include "control10k/notch.h"
#include "control10k/spectrum.h"

namespace control10k {

inline constexpr int kMaxSteady = 64;

struct SuppressionConfig {
  double period_s = 1e-4;
  int notches = 2;             // N_f
  double radius = 0.995;       // r
  double initial_Hz = 1500.0;  // of filters that are not in use yet: they filter there, as in the thesis
  int block = 128, bins = 24;  // N, N_g: bins 1 .. N_g
  double T_min_Nm = 20.0;
  double f_min_Hz = 156.0, f_max_Hz = 1797.0;
  int low_edge = 1, high_edge = 1;  // bins at either end that must not be the largest: p, q + 1
  double lobe_tolerance = 0.05, far_lobe_tolerance = 0.10;
  int steady = 10;  // N_s differences
  double epsilon_Hz = 10.0;
  double alpha = 1.0 - 1e-9, zeta = 1.1;
  // Probing: gamma = 0 switches it off.
  double probe_gamma = 0.0, probe_shift_Hz = 0.1;
  int probe_patience = 4;
};

/// Numbers fit the arrays, radii and frequencies their ranges.
bool IsUsable(const SuppressionConfig& config);

enum class Outcome { kNone, kQuiet, kEdge, kMixed, kMoving, kWeaker, kPlaced, kProbing, kRefused };

/// Only doubles: the state is an array that can be saved, compared and logged.
struct SuppressionState {
  Notch notch[kMaxNotches];
  double f_Hz[kMaxNotches], eta_Nm[kMaxNotches];
  Goertzel bank;
  double history[kMaxSteady];  // of f_x, newest first
  double results = 0.0;        // in the history
  double outcome = 0.0;        // of the last block
  double found_Hz = 0.0, found_Nm = 0.0;
  double placements = 0.0, last_placed = -1.0;  // count; index of the filter
  double pending = -1.0;                        // filter that is retuned in this step
  double pending_nu_0 = 0.0, pending_r = 1.0;
  double probe = -1.0, probe_Hz = 0.0, probe_Nm = 0.0, probe_last_Hz = 0.0, probe_r = 1.0, probe_waited = 0.0;
};

class Suppression {
 public:
  /// The config must be usable (IsUsable).
  explicit Suppression(const SuppressionConfig& config);

  void Start(SuppressionState& state) const;
  /// Observes the sample, adapts when `adapt`, and returns the filtered sample.
  double Step(SuppressionState& state, double T_shaft_Nm, bool adapt) const;

  const SuppressionConfig& config() const { return config_; }
  /// Filters in the cascade: N_f, and a spare one for probing.
  int filters() const { return filters_; }

 private:
  void Decide(SuppressionState& state) const;
  Outcome Judge(SuppressionState& state, const double* magnitudes, const Peak& peak) const;
  /// Enters a placement into the vectors f and eta.
  void Enter(SuppressionState& state, int filter, double f_Hz, double eta_Nm) const;
  /// The filter that takes the next frequency: the first free one, or when N_f are in use the one with the smallest
  /// eta.
  int Weakest(const SuppressionState& state) const;
  Outcome Probe(SuppressionState& state, const double* magnitudes) const;
  /// Retunes that filter within this step, when its input is known.
  void Request(SuppressionState& state, int filter, double f_Hz, double r) const;

  SuppressionConfig config_;
  GoertzelTables tables_;
  int filters_ = 0;
};

}  // namespace control10k
