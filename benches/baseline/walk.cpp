// The walk, plainly: see README.md beside this file.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <random>
#include <string>
#include <vector>

struct Particle {
    int32_t node;
    double diameter;
};

struct Curve {
    std::vector<double> percent, diameter;

    explicit Curve(const std::string &path) {
        std::ifstream file(path);
        std::string line;
        while (std::getline(file, line)) {
            double p, d;
            if (std::sscanf(line.c_str(), "%lf,%lf", &p, &d) == 2) {
                percent.push_back(p);
                diameter.push_back(d);
            }
        }
    }

    double at(double p) const {
        size_t i = 1;
        while (i + 1 < percent.size() && percent[i] < p) i++;
        double share = (p - percent[i - 1]) / (percent[i] - percent[i - 1]);
        return diameter[i - 1] + share * (diameter[i] - diameter[i - 1]);
    }
};

// Processor time: other work on the machine does not count.
static double seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

int main(int argc, char **argv) {
    if (argc != 6) return 1;
    const int64_t n = std::atoll(argv[1]);
    const Curve curve(argv[2]);
    const std::string scene = argv[3];
    std::mt19937_64 random(std::atoll(argv[4]));
    const int until = std::atoi(argv[5]);
    const int nx = 40, ny = 40, nz = 60, plane = nx * ny, voids = plane * nz, increments = 100;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);

    std::vector<double> diameter(3 * voids);
    for (double &d : diameter) d = curve.at(100.0 * uniform(random));
    std::vector<int32_t> target(3 * voids);
    for (int v = 0; v < voids; v++) {
        int x = v % nx, y = v / nx % ny, z = v / plane;
        target[3 * v] = v - x + (x + 1) % nx;
        target[3 * v + 1] = v + ((y + 1) % ny - y) * nx;
        target[3 * v + 2] = z + 1 == nz ? -1 : v + plane;
    }

    const double cu = 4.5;
    const double d0 = scene == "passive" ? 0.16 / (cu * cu) : curve.at(5.0) / std::pow(cu, 1.7);
    const double y0 = std::pow(d0, -3.0), y1 = std::pow(d0 * cu * cu, -3.0);

    std::vector<bool> blocked(3 * voids, false);
    std::vector<Particle> particles;
    particles.reserve(n);
    std::vector<int32_t> newly_blocked;
    std::vector<int64_t> retained(voids, 0);
    int64_t steps = 0, steps_after = 0, eroded = 0, blocked_count = 0;
    double eroded_mass = 0.0, largest_eroded = 0.0, time_after = 0.0;
    std::uniform_int_distribution<int32_t> start(0, plane - 1);

    const double begin = seconds();
    for (int t = 1; t <= increments || !particles.empty(); t++) {
        if (until > 0 && t > until) break;
        const double began = seconds();
        if (t <= increments) {
            for (int64_t i = n * (t - 1) / increments; i < n * t / increments; i++) {
                double d = std::pow(y0 + uniform(random) * (y1 - y0), -1.0 / 3.0);
                particles.push_back({start(random), d});
            }
        }
        const int64_t moving = particles.size();
        steps += moving;
        size_t kept = 0;
        for (const Particle &particle : particles) {
            const int first = 3 * particle.node;
            double area[3], total = 0.0;
            for (int e = 0; e < 3; e++) {
                area[e] = blocked[first + e] ? 0.0 : diameter[first + e] * diameter[first + e];
                total += area[e];
            }
            if (total == 0.0) {
                retained[particle.node]++;
                continue;
            }
            double draw = uniform(random) * total;
            int exit = 0;
            while (exit < 2 && draw >= area[exit]) draw -= area[exit++];
            while (area[exit] == 0.0) exit--;
            if (particle.diameter > diameter[first + exit]) {
                retained[particle.node]++;
                newly_blocked.push_back(first + exit);
                continue;
            }
            const int32_t to = target[first + exit];
            if (to < 0) {
                eroded++;
                eroded_mass += particle.diameter * particle.diameter * particle.diameter;
                if (particle.diameter > largest_eroded) largest_eroded = particle.diameter;
                continue;
            }
            particles[kept++] = {to, particle.diameter};
        }
        particles.resize(kept);
        for (int32_t c : newly_blocked) {
            if (!blocked[c]) blocked_count++;
            blocked[c] = true;
        }
        newly_blocked.clear();
        if (t > increments) {
            time_after += seconds() - began;
            steps_after += moving;
        }
    }
    const double all = seconds() - begin;
    std::printf("steps %lld ns_step_all %.4f steps_after %lld ns_step_after %.4f eroded %lld blocked %lld eroded_mass %.6g\n",
                (long long)steps, all / steps * 1e9, (long long)steps_after, time_after / steps_after * 1e9,
                (long long)eroded, (long long)blocked_count, eroded_mass);
}
