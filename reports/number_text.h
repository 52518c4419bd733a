#pragma once
#include <string>

/// Numbers as a reader of a report wants them: few significant digits, a unit prefix that fits, a true minus sign.
namespace grouser {

/// "13.98", "−0.0031", "2.4 × 10⁻⁵", "151 234" (thin spaces from five digits on); NaN gives "–".
[[nodiscard]] std::string number_text(double value, int digits = 4);
/// Whole numbers with thin spaces: "151 234".
[[nodiscard]] std::string count_text(long value);
/// A value in SI `unit` ("N", "N m", "J", "s", "m", "m/s", "1", ...) with the prefix that fits: "82.4 kN", "0.113 ms",
/// "1.2 rad/s".
[[nodiscard]] std::string quantity_text(double value, const std::string& unit, int digits = 4);
/// "3.2 %" of a fraction.
[[nodiscard]] std::string percent_text(double fraction, int digits = 3);

/// "3.20 %" of a fraction with that many decimals.
[[nodiscard]] std::string fixed_percent_text(double fraction, int decimals);
/// "+1.2 %", "−0.4 %", "0.0 %": a change as a fraction, with that many decimals and no sign on a rounded zero.
[[nodiscard]] std::string signed_percent_text(double fraction, int decimals = 1);

}  // namespace grouser
