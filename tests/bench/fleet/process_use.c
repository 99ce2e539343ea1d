#include "tests/bench/fleet/process_use.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/bench/fleet/fleet_table.h"

const char *fleet_part_name(enum fleet_part part)
{
    static const char *const names[] = {"broker", "hub", "postgres", "doors"};
    return names[part];
}

/* The processor time of a process; with `dead` also that of its children which have ended. */
static double cpu_of(long pid, int with_dead)
{
    char path[64], text[1024] = "";
    unsigned long user = 0, system = 0;
    long dead_user = 0, dead_system = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/stat", pid);
    FILE *in = fopen(path, "re");
    if (!in) {
        return 0;
    }
    const size_t n = fread(text, 1, sizeof text - 1, in);
    (void)fclose(in);
    text[n] = '\0';
    const char *end = strrchr(text, ')'); /* of the name, which may contain anything */
    if (!end || sscanf(end, ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %ld %ld", &user,
                       &system, &dead_user, &dead_system) != 4) {
        return 0;
    }
    const double ticks = (double)sysconf(_SC_CLK_TCK);
    return ((double)(user + system) + (with_dead ? (double)(dead_user + dead_system) : 0)) / ticks;
}

/* A line of /proc/PID/status or smaps_rollup, in 10^6 bytes. */
static double memory_of(long pid, const char *file, const char *word)
{
    char path[64], line[256];
    double kib = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/%s", pid, file);
    FILE *in = fopen(path, "re");
    while (in && fgets(line, sizeof line, in)) {
        if (strncmp(line, word, strlen(word)) == 0) {
            kib += strtod(line + strlen(word), NULL);
        }
    }
    if (in) {
        (void)fclose(in);
    }
    return kib * 1024e-6;
}

/* A process with all that it has started: the server may have been started by another program. */
static void add_tree(struct process_use *use, enum fleet_part part, long pid)
{
    char path[64], word[32];
    (void)snprintf(path, sizeof path, "/proc/%ld/task/%ld/children", pid, pid);
    FILE *in = fopen(path, "re");
    use->cpu_s[part] += cpu_of(pid, 1);
    use->mb[part] += memory_of(pid, "smaps_rollup", "Private_Dirty:");
    while (in && fscanf(in, "%31s", word) == 1) {
        add_tree(use, part, strtol(word, NULL, 10));
    }
    if (in) {
        (void)fclose(in);
    }
}

struct process_use process_use_now(const char *pids_file)
{
    struct process_use use = {.at_ns = fleet_table_now_ns()};
    char word[16];
    long pid = 0;
    FILE *in = fopen(pids_file, "re");
    while (in && fscanf(in, "%15s %ld", word, &pid) == 2) {
        for (enum fleet_part part = 0; part < FLEET_PARTS; part++) {
            if (strcmp(word, fleet_part_name(part)) != 0) {
                continue;
            }
            if (part == FLEET_POSTGRES) {
                add_tree(&use, part, pid);
            } else {
                use.cpu_s[part] += cpu_of(pid, 0);
                use.mb[part] += memory_of(pid, "status", "VmRSS:");
            }
        }
    }
    if (in) {
        (void)fclose(in);
    }
    return use;
}

/* Adds the number after a word of a line. */
static double number_after(const char *line, const char *word)
{
    const char *at = strstr(line, word);
    return at ? strtod(at + strlen(word), NULL) : 0;
}

double process_use_bytes(uint16_t port)
{
    char command[80], line[1024];
    double bytes = 0;
    (void)snprintf(command, sizeof command, "ss -tinHO 'sport = :%u' 2>/dev/null", port);
    FILE *in = popen(command, "re");
    while (in && fgets(line, sizeof line, in)) {
        bytes += number_after(line, " bytes_sent:") + number_after(line, " bytes_received:");
    }
    if (in) {
        (void)pclose(in);
    }
    return bytes;
}
