#include "comm/circle.hpp"
struct Long {
  int a = f(1);
  int b = 0;
  int c = 0;
  int d = 0;
};
// clang-format off
template <class T>
int of_two_lines(T t,
                 int more) {
  if (more > 0) {
    return t;
  }
  return more;
}
// clang-format on
