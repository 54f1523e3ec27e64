// The yardstick: perception entropy of one LiDAR on the whole grid, written as one would say it.
// For every voxel: every beam that may touch it is tested against the cube; then AP, sigma, H and
// the prior. No tables, no reuse between voxels. Two threads share the x-planes.
// Usage: literal PROBLEM; PROBLEM is float64s as benchmarks/literal.py writes them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>
#include <vector>

static std::vector<double> data;
static const double *next_block(size_t &at, size_t n) { at += n; return data.data() + at - n; }

int main(int argc, char **argv) {
    std::ifstream file(argc > 1 ? argv[1] : "", std::ios::binary | std::ios::ate);
    if (!file) { std::fprintf(stderr, "literal: no problem file\n"); return 1; }
    data.resize(file.tellg() / sizeof(double));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(data.data()), data.size() * sizeof(double));
    size_t at = 0;
    const double *head = next_block(at, 10);
    const int nx = head[0], ny = head[1], nz = head[2], channels = head[3], azimuths = head[4];
    const int classes = head[5];
    const double side = head[6], a = head[7], b = head[8];
    const double *low = next_block(at, 3), *origin = next_block(at, 3);
    const double *rotation = next_block(at, 9);          // ground_from_sensor, row by row
    const double *elevations = next_block(at, channels);  // ascending
    const double *directions = next_block(at, 3 * size_t(channels) * azimuths);
    const double *ends = next_block(at, size_t(channels) * azimuths);
    const double *ground = next_block(at, size_t(nx) * ny * classes);
    const double *profile = next_block(at, size_t(nz) * classes);
    const double *top = next_block(at, size_t(nx) * ny);  // height of the vehicle by column
    const double step = 2 * M_PI / azimuths, ball = side * std::sqrt(3.0) / 2;
    const int threads = std::max(1.0, head[9]);
    std::vector<double> sum_h(threads), sum_p(threads);

    auto planes = [&](int worker) {
        double total_h = 0, total_p = 0;
        for (int i = worker; i < nx; i += threads)
            for (int j = 0; j < ny; j++)
                for (int k = 0; k < nz; k++) {
                    const double c[3] = {low[0] + (i + 0.5) * side, low[1] + (j + 0.5) * side,
                                         low[2] + (k + 0.5) * side};
                    if (c[2] < top[size_t(i) * ny + j]) continue;
                    const double d[3] = {c[0] - origin[0], c[1] - origin[1], c[2] - origin[2]};
                    double s[3];
                    for (int w = 0; w < 3; w++)
                        s[w] = rotation[w] * d[0] + rotation[3 + w] * d[1] + rotation[6 + w] * d[2];
                    const double flat = std::hypot(s[0], s[1]), r = std::hypot(flat, s[2]);
                    const double up = r > ball ? std::asin(ball / r) : M_PI;
                    const double wide = flat > ball ? std::asin(ball / flat) : M_PI;
                    const double e = std::atan2(s[2], flat), az = std::atan2(s[1], s[0]);
                    const int c0 = std::lower_bound(elevations, elevations + channels, e - up) - elevations;
                    const int c1 = std::upper_bound(elevations, elevations + channels, e + up) - elevations;
                    const int j0 = std::ceil((az - wide) / step);
                    const int j1 = std::min<int>(std::floor((az + wide) / step), j0 + azimuths - 1);
                    int m = 0;
                    for (int ch = c0; ch < c1; ch++)
                        for (int jj = j0; jj <= j1; jj++) {
                            const size_t beam = size_t(ch) * azimuths + ((jj % azimuths) + azimuths) % azimuths;
                            double enter = 0, leave = ends[beam];
                            for (int w = 0; w < 3; w++) {
                                const double inverse = 1 / directions[3 * beam + w];
                                const double t0 = (d[w] - side / 2) * inverse, t1 = (d[w] + side / 2) * inverse;
                                enter = std::max(enter, std::min(t0, t1));
                                leave = std::min(leave, std::max(t0, t1));
                            }
                            m += enter < leave;
                        }
                    const double ap = m ? std::clamp(a * std::log(double(m)) + b, 0.001, 0.999) : 0.001;
                    const double h = 2 * std::log(1 / ap - 1) + 1 + std::log(2 * M_PI);
                    double p = 0;
                    for (int q = 0; q < classes; q++)
                        p += ground[(size_t(i) * ny + j) * classes + q] * profile[size_t(k) * classes + q];
                    total_h += p * h;
                    total_p += p;
                }
        sum_h[worker] = total_h;
        sum_p[worker] = total_p;
    };
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> pool;
    for (int w = 0; w < threads; w++) pool.emplace_back(planes, w);
    for (auto &t : pool) t.join();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    double h = 0, p = 0;
    for (int w = 0; w < threads; w++) h += sum_h[w], p += sum_p[w];
    std::printf("%.17g %.6f\n", h / p, spent.count());
}
