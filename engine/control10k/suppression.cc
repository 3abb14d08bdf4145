#include "control10k/suppression.h"

#include <cmath>

namespace control10k {
namespace {}  // namespace

bool IsUsable(const SuppressionConfig& c) {
  GoertzelTables tables;
  const double nyquist = 0.5 / c.period_s;
  return c.period_s > 0.0 && c.notches >= 1 && c.notches < kMaxNotches && c.radius > 0.0 && c.radius <= 1.0 &&
         c.initial_Hz > 0.0 && c.initial_Hz < nyquist && MakeTables(c.block, c.bins, tables) && c.T_min_Nm >= 0.0 &&
         c.f_min_Hz > 0.0 && c.f_min_Hz < c.f_max_Hz && c.f_max_Hz < nyquist && c.low_edge >= 1 && c.high_edge >= 1 &&
         c.low_edge + c.high_edge < c.bins && c.lobe_tolerance > 0.0 && c.far_lobe_tolerance > 0.0 && c.steady >= 1 &&
         c.steady < kMaxSteady && c.epsilon_Hz > 0.0 && c.alpha > 0.0 && c.alpha <= 1.0 && c.zeta >= 1.0 &&
         c.probe_gamma >= 0.0 && c.probe_gamma < 1.0 && c.probe_shift_Hz >= 0.0 && c.probe_patience >= 1;
}

Suppression::Suppression(const SuppressionConfig& config) : config_(config) {
  MakeTables(config.block, config.bins, tables_);
  filters_ = config.notches + (config.probe_gamma > 0.0 ? 1 : 0);
}

void Suppression::Start(SuppressionState& state) const {
  state = SuppressionState();
  for (double& f : state.history) f = 0.0;
  for (int i = 0; i < kMaxNotches; ++i) {
    state.f_Hz[i] = config_.initial_Hz;
    state.eta_Nm[i] = 0.0;
    Notch& notch = state.notch[i];
    notch = {};
    notch.nu_0 = kTwoPi * config_.initial_Hz * config_.period_s;
    if (i < config_.notches && config_.probe_gamma == 0.0) {
      notch.r = config_.radius;
      DesignNotch(notch.nu_0, notch.r, notch.c);
    }
  }
  state.probe = -1.0;
}

double Suppression::Step(SuppressionState& state, double T_shaft_Nm, bool adapt) const {
  if (adapt) {
    for (int i = 0; i < filters_; ++i) {  // (5.37)
      double& eta = state.eta_Nm[i];
      if (eta > 0.0) {
        const double faded = config_.alpha * eta, lowest = config_.zeta * config_.T_min_Nm;
        eta = faded > lowest ? faded : lowest;
      }
    }
    if (state.bank.Step(tables_, T_shaft_Nm)) Decide(state);
  } else if (state.bank.count > 0.0 || state.results > 0.0) {
    state.bank.Reset();
    state.results = 0.0;
    state.outcome = 0.0;
    if (state.probe >= 0.0) Request(state, static_cast<int>(state.probe), config_.initial_Hz, 1.0);
    state.probe = -1.0;
  }
  double signal = T_shaft_Nm;
  const int pending = static_cast<int>(state.pending);
  for (int i = 0; i < filters_; ++i) {
    if (i == pending) {
      state.notch[i].Retune(state.pending_nu_0, state.pending_r, signal);
      state.pending = -1.0;
    }
    signal = state.notch[i].Step(signal);
  }
  return signal;
}

int Suppression::Weakest(const SuppressionState& state) const {
  int in_use = 0;
  for (int i = 0; i < filters_; ++i) in_use += state.eta_Nm[i] > 0.0 ? 1 : 0;
  int weakest = -1;
  for (int i = 0; i < filters_; ++i) {
    if (i == static_cast<int>(state.probe)) continue;
    if (in_use >= config_.notches && !(state.eta_Nm[i] > 0.0)) continue;  // the spare one is no choice any more
    if (weakest < 0 || state.eta_Nm[i] < state.eta_Nm[weakest]) weakest = i;
  }
  return weakest;
}

Outcome Suppression::Judge(SuppressionState& state, const double* magnitudes, const Peak& peak) const {
  if (!peak.interior) {
    state.results = 0.0;
  } else {
    for (int i = config_.steady; i > 0; --i) state.history[i] = state.history[i - 1];
    state.history[0] = peak.frequency_Hz;
    if (state.results <= config_.steady) state.results += 1.0;
  }
  if (!(peak.amplitude > config_.T_min_Nm)) return Outcome::kQuiet;
  if (!peak.interior || peak.bin <= config_.low_edge || peak.bin > config_.bins - config_.high_edge ||
      !(peak.frequency_Hz > config_.f_min_Hz && peak.frequency_Hz < config_.f_max_Hz)) {
    return Outcome::kEdge;
  }
  const int near = peak.offset >= 0.0 ? 1 : -1;
  if (!(LobeMisfit(magnitudes, peak, near) < config_.lobe_tolerance &&
        LobeMisfit(magnitudes, peak, -near) < config_.far_lobe_tolerance)) {
    return Outcome::kMixed;
  }
  if (state.results <= config_.steady) return Outcome::kMoving;
  double sum = 0.0;
  for (int i = 0; i < config_.steady; ++i) sum += std::abs(state.history[i] - state.history[i + 1]);
  if (!(sum < config_.epsilon_Hz)) return Outcome::kMoving;
  if (!(peak.amplitude >= state.eta_Nm[Weakest(state)])) return Outcome::kWeaker;
  return Outcome::kPlaced;
}

void Suppression::Request(SuppressionState& state, int filter, double f_Hz, double r) const {
  state.pending = filter;
  state.pending_nu_0 = kTwoPi * f_Hz * config_.period_s;
  state.pending_r = r;
}

void Suppression::Enter(SuppressionState& state, int filter, double f_Hz, double eta_Nm) const {
  state.f_Hz[filter] = f_Hz;
  state.eta_Nm[filter] = eta_Nm;
  state.placements += 1.0;
  state.last_placed = filter;
  state.results = 0.0;
}

Outcome Suppression::Probe(SuppressionState& state, const double* magnitudes) const {
  const int filter = static_cast<int>(state.probe);
  const Peak peak = FindPeak(magnitudes, tables_.bins, tables_.block, config_.period_s);
  const double bin_Hz = 1.0 / (config_.block * config_.period_s);
  const bool gone =
      !peak.interior || !(peak.amplitude > config_.T_min_Nm) || std::abs(peak.frequency_Hz - state.probe_Hz) > bin_Hz;
  const bool smallest = state.probe_r <= config_.radius;
  const auto stay = [&] {
    // When all N_f are in use the weakest becomes the spare one, switched off.
    const int weakest = Weakest(state);
    if (state.eta_Nm[weakest] > 0.0) {
      Request(state, weakest, config_.initial_Hz, 1.0);
      state.f_Hz[weakest] = config_.initial_Hz;
      state.eta_Nm[weakest] = 0.0;
    }
    Enter(state, filter, state.probe_Hz, state.probe_Nm);
    state.probe = -1.0;
    return Outcome::kPlaced;
  };
  if (gone && state.probe_waited >= 1.0) return stay();
  if (!gone && std::abs(peak.frequency_Hz - state.probe_last_Hz) >= config_.probe_shift_Hz) {
    if (smallest) return stay();
    state.probe_last_Hz = peak.frequency_Hz;
    state.probe_waited = 0.0;
    const double r = state.probe_r - config_.probe_gamma;
    state.probe_r = r > config_.radius ? r : config_.radius;
    Request(state, filter, state.probe_Hz, state.probe_r);
    return Outcome::kProbing;
  }
  state.probe_waited += 1.0;
  if (state.probe_waited < config_.probe_patience) return Outcome::kProbing;
  Request(state, filter, state.probe_Hz, 1.0);
  state.probe = -1.0;
  state.results = 0.0;
  return Outcome::kRefused;
}

void Suppression::Decide(SuppressionState& state) const {
  double magnitudes[kMaxBins];
  state.bank.Magnitudes(tables_, magnitudes);
  Outcome outcome;
  if (state.probe >= 0.0) {
    outcome = Probe(state, magnitudes);
  } else {
    const Peak peak = FindPeak(magnitudes, tables_.bins, tables_.block, config_.period_s);
    state.found_Hz = peak.frequency_Hz;
    state.found_Nm = peak.amplitude;
    outcome = Judge(state, magnitudes, peak);
    if (outcome == Outcome::kPlaced && config_.probe_gamma > 0.0) {
      int spare = 0;
      while (state.eta_Nm[spare] > 0.0) ++spare;  // one of the N_f + 1 filters is always free
      state.probe = spare;
      state.probe_Hz = state.probe_last_Hz = peak.frequency_Hz;
      state.probe_Nm = peak.amplitude;
      state.probe_r = 1.0 - config_.probe_gamma;
      if (state.probe_r < config_.radius) state.probe_r = config_.radius;
      state.probe_waited = 0.0;
      Request(state, spare, state.probe_Hz, state.probe_r);
      outcome = Outcome::kProbing;
    } else if (outcome == Outcome::kPlaced) {
      const int filter = Weakest(state);
      Request(state, filter, peak.frequency_Hz, config_.radius);
      Enter(state, filter, peak.frequency_Hz, peak.amplitude);
    }
  }
  state.outcome = static_cast<double>(outcome);
}

}  // namespace control10k
