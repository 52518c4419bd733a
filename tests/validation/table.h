#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

/// The validation table: what the program computes beside what is known from elsewhere (docs/validation.md).
namespace grouser::validation {

/// How far from the reference a measured value may be.
struct Limit {
  double error = 0.0;   ///< largest error that passes, in the row's unit or as a fraction of `scale`
  double scale = 0.0;   ///< what a relative error is a fraction of, > 0; 0: the error is absolute
  std::string because;  ///< why it is not zero, in a few words
};
/// |measured - reference| <= error, in the row's unit.
[[nodiscard]] Limit within(double error, std::string because);
/// |measured - reference| <= fraction * |of|.
[[nodiscard]] Limit fraction(double fraction, double of, std::string because);

/// One comparison. Numbers are in `unit`; what is shown is what was compared.
struct Row {
  std::string quantity;    ///< unique within its chapter
  std::string unit;        ///< "" for a pure number
  double reference = 0.0;  ///< the known value
  double measured = 0.0;   ///< what the program computed just now, never a number written down
  Limit limit;
  std::string source;  ///< where the reference comes from: publication and section, or "closed form" with formula

  [[nodiscard]] double error() const;  ///< as the limit counts it; NaN where `measured` is none
  [[nodiscard]] bool passes() const;   ///< false for NaN too
};

/// Where a vector is farthest from its reference.
struct Worst {
  double reference = 0.0, measured = 0.0;
};
[[nodiscard]] Worst worst_of(const Eigen::VectorXd& measured, const Eigen::VectorXd& reference);
/// Of two comparisons, the one that is farther off.
[[nodiscard]] Worst worse(const Worst& a, const Worst& b);

/// Rows of one chapter, in sections that each say what the scene is.
class Chapter {
 public:
  explicit Chapter(std::string title) : title_(std::move(title)) {}
  /// Begins a section; `scene`: one or two sentences on what is computed, and what is left out on purpose.
  void section(std::string title, std::string scene);
  void add(Row row);

  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] int num_rows() const;
  /// Names, numbers and errors of the rows that are out of their limit, a line each.
  [[nodiscard]] std::vector<std::string> failures() const;
  /// Markdown, headed by the title.
  [[nodiscard]] std::string text() const;

 private:
  struct Section {
    std::string title, scene;
    std::vector<Row> rows;
  };
  std::string title_;
  std::vector<Section> sections_;
};

/// The text under the chapter's title in a document made of such chapters, the title with it; empty where there is
/// none.
[[nodiscard]] std::string chapter_in(const std::string& document, const std::string& title);
/// Quantity and limit of every row under the chapter's title in a document made by `text`, in its order.
[[nodiscard]] std::vector<std::string> rows_in(const std::string& document, const std::string& title);

}  // namespace grouser::validation
