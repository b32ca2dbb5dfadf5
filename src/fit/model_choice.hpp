// Chooses the model that a log demands. Private to the fit room.
#pragma once

#include "model_fit.hpp"
#include "refinement.hpp"
#include "rivals.hpp"

#include <functional>
#include <map>

namespace goingrate::timing_model {

/// Whether the residuals are no larger than the scatter of neighbouring beats, `jitter` in seconds.
bool is_as_small_as(double jitter, const Fitted& fitted);

/// Whether the log determines a parameter of the fit.
bool is_determined(const Fitted& fitted, const Slot& slot);
/// Whether linear friction is given, or determined by the log.
bool determines_friction(const Fitted& fitted);

/// Error of each free parameter of the fit, in sigma and by name, as judged by other dynamics;
/// empty if these cannot run there.
std::map<std::string, double> model_shifts(const Fitted& fitted, FitDynamics judge);

/// The data a fit works on: all beats, or beats at a stride of a long log under drive noise.
struct Working {
  TimingData data;
  Thinning thinning;
};

/// The search for the model: escapement, noise, friction, dynamics and dates of change, each made
/// more complex only if the log demands it. The escapement is chosen in
/// escapement_choice.cpp, the noise in noise_choice.cpp.
class ModelSearch {
public:
  /// Laws to fit: which parameters change when (options), and the escapement and friction (model).
  struct Laws {
    FitOptions options;
    ModelChoice model;
  };
  /// Laws that explain the log as well as the chosen ones: which parameters change, and the values
  /// that the log then determines, by name.
  struct EqualLaws {
    std::string changed;
    std::map<std::string, double> values, sigmas;
  };
  /// What a search had settled before it looked at the noise, with the notes about that.
  struct Settled {
    Laws laws;
    std::vector<EqualLaws> equal;
    std::vector<FitAlternative> alternatives;
    std::vector<FitNote> notes;
  };

  ModelSearch(const TimingData& data, const FitOptions& options);
  /// Starts from the laws of another search of the same data, with changes that may come at any
  /// moment unless they were stated to come at a crossing.
  ModelSearch(const TimingData& data, const Settled& settled);

  /// Runs the search. `what` names it in messages about its progress: "fitting the model". The
  /// result points into this object.
  const Fitted& run(std::string_view what, const FitStage& now);
  [[nodiscard]] const Thinning& thinning() const { return working_.thinning; }
  [[nodiscard]] const std::string& chosen_by() const { return chosen_by_; }
  [[nodiscard]] const std::vector<FitAlternative>& alternatives() const { return alternatives_; }
  /// The given options, with events and priors as the search has changed them.
  [[nodiscard]] const FitOptions& options() const { return options_; }
  /// Findings of the search that the user must be told.
  [[nodiscard]] const std::vector<FitNote>& notes() const { return notes_; }
  [[nodiscard]] const Settled& settled() const { return settled_; }
  /// Errors of first-order averaging alone, in sigma and by name; empty if not known.
  [[nodiscard]] const std::map<std::string, double>& first_order_shifts() const { return shifts_; }

private:
  void thin_if_long();
  [[nodiscard]] ModelChoice first_model() const;
  void include_angle_of_pushes();
  [[nodiscard]] bool explains(const Fitted& fitted) const;
  [[nodiscard]] Fitted roughly_fitted(const FitOptions& options, const ModelChoice& model,
                                      TimingData& thin) const;
  [[nodiscard]] bool is_told_of_torque() const;
  [[nodiscard]] std::vector<Laws> other_laws(const Laws& than) const;
  /// Laws and a fit with them.
  struct FittedLaws {
    Laws laws;
    Fitted fitted;
  };
  [[nodiscard]] std::optional<FittedLaws> laws_that_explain(const FittedLaws& driven) const;
  void let_times_walk(FittedLaws& drive, const Fitted& other, FitDynamics judge) const;
  [[nodiscard]] bool slow_drive_evens(const FittedLaws& drive) const;
  [[nodiscard]] Fitted with_slow_drive(FittedLaws& drive, FitDynamics dynamics) const;
  [[nodiscard]] Fitted roughly_fitted_near(const Laws& laws, std::size_t changed,
                                           TimingData& thin) const;
  [[nodiscard]] Fitted wholly_fitted(const Fitted& rough, const FitOptions& options) const;
  [[nodiscard]] std::vector<FittedLaws> compared_laws(const Laws& here) const;
  std::vector<EqualLaws> choose_laws(const std::vector<FitEvent>& found);
  bool take_laws(const FittedLaws& better);
  /// `compared`: the chosen laws first.
  [[nodiscard]] std::vector<EqualLaws> equal_laws(const std::vector<FittedLaws>& compared) const;
  [[nodiscard]] bool prefers_no_escapement(const ModelChoice& driven, ModelChoice& chosen);
  void leave_out_contradicted_priors();
  void settle_laws();
  void find_moments();
  void choose_dynamics();
  void add_terms(Fitted& fitted);
  bool add_best_term(Fitted& fitted);
  void explain_roughly(Fitted& rough);
  void choose_friction();
  [[nodiscard]] double straying(const Fitted& fitted) const;
  [[nodiscard]] bool is_steady_walk() const;
  [[nodiscard]] bool strays_by_noise() const;
  [[nodiscard]] bool noise_is_asked_for() const;
  void choose_noise();
  void take_dates_of_best();
  void choose_on_few_beats(const std::function<void()>& choose);
  [[nodiscard]] TimingData beats_to_judge(std::size_t stride) const;
  [[nodiscard]] std::size_t longest_stride() const;
  void thin_by_information();
  bool take_if_better(Fitted&& other, const std::string& why);
  void choose_slow_drive(Fitted&& slow);
  void add_other_noise();
  void tried(const Fitted& fitted, const std::string& verdict);

  const TimingData& all_;
  FitOptions options_;
  bool moments_ = false;
  Settled settled_;
  NoiseGuess guess_;
  Working working_;
  TimingData finer_; ///< the beats that thin_by_information() keeps
  Fitted best_;
  /// The fit with or without slow drive that the log hardly distinguishes from the chosen one, and
  /// the point at which the chosen one was then.
  struct OtherNoise {
    Rival rival;
    std::vector<double> beside;
  };
  std::optional<OtherNoise> other_noise_;
  std::map<std::string, double> shifts_; // by name, because terms added later shift the indices
  std::string chosen_by_;
  std::vector<FitNote> notes_;
  std::vector<FitAlternative> alternatives_;
};

} // namespace goingrate::timing_model
