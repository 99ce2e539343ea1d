#include "tests/vm/gpio/gpio_sim.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define CONFIGURATION "/sys/kernel/config/gpio-sim"

enum { PATH_SIZE = 256 };

static void write_text(const char *path, const char *text)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0 || write(fd, text, strlen(text)) != (ssize_t)strlen(text)) {
        fail_msg("%s: %s", path, strerror(errno));
    }
    assert_int_equal(close(fd), 0);
}

static void read_word(const char *path, char *word, size_t size)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const ssize_t n = fd < 0 ? -1 : read(fd, word, size - 1);
    if (n < 0) {
        fail_msg("%s: %s", path, strerror(errno));
    }
    word[n] = '\0';
    word[strcspn(word, "\n")] = '\0';
    assert_int_equal(close(fd), 0);
}

static void make_directory(const char *path)
{
    if (mkdir(path, 0755)) {
        fail_msg("%s: %s", path, strerror(errno));
    }
}

void gpio_sim_make(const char *name, const char *prefix)
{
    char path[PATH_SIZE], text[64];
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s", name);
    make_directory(path);
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank", name);
    make_directory(path);
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/num_lines", name);
    (void)snprintf(text, sizeof text, "%d", GPIO_SIM_LINES);
    write_text(path, text);
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/label", name);
    write_text(path, name);
    for (int i = 0; i < GPIO_SIM_LINES; i++) {
        (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/line%d", name, i);
        make_directory(path);
        (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/line%d/name", name, i);
        (void)snprintf(text, sizeof text, "%s%d", prefix, i);
        write_text(path, text);
    }
    gpio_sim_plug(name, true);
}

void gpio_sim_plug(const char *name, bool in)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/live", name);
    write_text(path, in ? "1" : "0");
}

void gpio_sim_remove(const char *name)
{
    char path[PATH_SIZE];
    gpio_sim_plug(name, false);
    for (int i = 0; i < GPIO_SIM_LINES; i++) {
        (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/line%d", name, i);
        assert_int_equal(rmdir(path), 0);
    }
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank", name);
    assert_int_equal(rmdir(path), 0);
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s", name);
    assert_int_equal(rmdir(path), 0);
}

const char *gpio_sim_chip(const char *name)
{
    static char chip[32];
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, CONFIGURATION "/%s/bank/chip_name", name);
    read_word(path, chip, sizeof chip);
    return chip;
}

/* Makes the path of a line's attribute: .../sim_gpioN/WHAT */
static void attribute(const char *name, unsigned line, const char *what, char path[PATH_SIZE])
{
    char device[64];
    (void)snprintf(path, PATH_SIZE, CONFIGURATION "/%s/dev_name", name);
    read_word(path, device, sizeof device);
    (void)snprintf(path, PATH_SIZE, "/sys/devices/platform/%s/%s/sim_gpio%u/%s", device,
                   gpio_sim_chip(name), line, what);
}

void gpio_sim_pull(const char *name, unsigned line, bool high)
{
    char path[PATH_SIZE];
    attribute(name, line, "pull", path);
    write_text(path, high ? "pull-up" : "pull-down");
}

bool gpio_sim_voltage(const char *name, unsigned line)
{
    char path[PATH_SIZE], word[8];
    attribute(name, line, "value", path);
    read_word(path, word, sizeof word);
    return word[0] == '1';
}
