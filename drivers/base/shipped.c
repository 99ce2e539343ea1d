#include "drivers/base/shipped.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Enough for BUILD/sim/isotherm-sim and BUILD/tests/sim/test_..., and one more. */
enum { LEVELS = 3 };

static char model[PATH_MAX + 32], metric[PATH_MAX + 32], cohort[PATH_MAX + 32];
static pthread_once_t once = PTHREAD_ONCE_INIT;

/* Removes the last part of a path. Returns false if the path has only one part. */
static bool cut(char *path)
{
    char *slash = strrchr(path, '/');
    if (!slash || slash == path) {
        return false;
    }
    *slash = '\0';
    return true;
}

void iso_shipped_directory(const char *program, char directory[PATH_MAX])
{
    char above[PATH_MAX], link[PATH_MAX + sizeof ISO_SHIPPED_LINK];
    if (strlen(program) < sizeof above) {
        (void)snprintf(above, sizeof above, "%s", program);
        bool more = cut(above);
        for (int level = 0; level < LEVELS && more && (more = cut(above)); level++) {
            (void)snprintf(link, sizeof link, "%s/" ISO_SHIPPED_LINK, above);
            if (realpath(link, directory)) {
                return;
            }
        }
    }
    (void)snprintf(directory, PATH_MAX, "%s", ISOTHERM_DATA_DIR);
}

static void find(void)
{
    char program[PATH_MAX] = "", directory[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    iso_shipped_directory(program, directory);
    (void)snprintf(model, sizeof model, "%s/head.model", directory);
    (void)snprintf(metric, sizeof metric, "%s/face.metric", directory);
    (void)snprintf(cohort, sizeof cohort, "%s/cohort.templates", directory);
}

static const char *found(const char *path)
{
    (void)pthread_once(&once, find);
    return path;
}

const char *iso_shipped_model(void)
{
    return found(model);
}

const char *iso_shipped_metric(void)
{
    return found(metric);
}

const char *iso_shipped_cohort(void)
{
    return found(cohort);
}
