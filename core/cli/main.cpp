#include <cstdio>

int main() {
  std::fputs("sightline: no command yet\n", stderr);
  return 2;
}
