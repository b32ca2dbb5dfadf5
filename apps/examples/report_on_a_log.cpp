// A log becomes a report: report_on_a_log LOG PAGE.html
#include <goingrate/goingrate.hpp>

#include <fstream>
#include <iostream>

int main(int count, char** words) {
  using namespace goingrate;
  if (count != 3) {
    std::cerr << "report_on_a_log LOG PAGE.html\n";
    return 2;
  }
  try {
    LoadRequest request;
    request.path = words[1];
    const Analysis analysis = analyse(load(request));
    std::cout << report_text(analysis);
    if (const FittedParameter* epsilon = analysis.fit.find("epsilon"))
      std::cout << "epsilon = " << epsilon->value << " ± " << epsilon->sigma << "\n";
    std::ofstream(words[2]) << report_html(analysis);
  } catch (const InputError& error) { // file, line, column, what was found and what was expected
    std::cerr << error.what() << "\n";
    return 3;
  }
}
