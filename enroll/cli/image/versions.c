#include "enroll/cli/image/versions.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#include "enroll/cli/machine/child.h"
#include "enroll/cli/machine/text_file.h"
#include "enroll/cli/text/report.h"

/* Debian adds the number of the binary interface to the name of a library: the package of libgpiod
 * is libgpiod2, and a later release may have another number. The libraries of SuiteSparse have one
 * version, so one of them stands for all. */
static const struct {
    const char *name, *package;
} libraries[CLI_LIBRARIES] = {
    {"libcamera", "libcamera"},    {"OpenNI2", "libopenni2-"}, {"OpenCV", "libopencv-core"},
    {"SuiteSparse", "libcholmod"}, {"libgpiod", "libgpiod"},
};

/* Takes the version from a line PACKAGE<tab>VERSION if it is that of a library. */
static void take_line(const char *line, struct cli_library *out)
{
    for (size_t i = 0; i < CLI_LIBRARIES; i++) {
        const size_t length = strlen(libraries[i].package);
        const char *version = line + strcspn(line, "\t\n");
        if (strncmp(line, libraries[i].package, length) == 0 && line[length] >= '0' &&
            line[length] <= '9' && *version == '\t') {
            version++;
            (void)snprintf(out[i].version, sizeof out[i].version, "%.*s",
                           (int)strcspn(version, "\t\n"), version);
        }
    }
}

static void take_lines(const char *text, struct cli_library *out)
{
    for (const char *line = text; *line; line += strspn(line, "\n")) {
        take_line(line, out);
        line += strcspn(line, "\n");
    }
}

/* dpkg-query ends with an error if one of the packages is not installed, and lists the others. */
static void ask_dpkg(const char *program, struct cli_library *out)
{
    const char *argv[CLI_LIBRARIES + 5] = {program, "--show",
                                           "--showformat=${Package}\\t${Version}\\n"};
    char patterns[CLI_LIBRARIES][32];
    struct cli_fault ignored = {.text = ""};
    struct cli_child child = {0};

    for (size_t i = 0; i < CLI_LIBRARIES; i++) {
        (void)snprintf(patterns[i], sizeof patterns[i], "%s[0-9]*", libraries[i].package);
        argv[3 + i] = patterns[i];
    }
    if (cli_child_run(argv, &child, &ignored) == CLI_EXIT_OK) {
        take_lines(child.out, out);
    }
    cli_child_done(&child);
}

static void read_libraries(const struct cli_image_places *places, struct cli_library *out)
{
    char *text = cli_text_file_read(places->packages, NULL);

    for (size_t i = 0; i < CLI_LIBRARIES; i++) {
        out[i].name = libraries[i].name;
    }
    if (text) {
        take_lines(text, out);
    } else {
        ask_dpkg(places->dpkg_query, out);
    }
    free(text);
}

void cli_versions_read(const struct cli_image_places *places, struct cli_versions *out)
{
    struct utsname kernel;

    *out = (struct cli_versions){.daemon = ""};
    read_libraries(places, out->libraries);
    if (uname(&kernel) == 0) {
        (void)snprintf(out->kernel, sizeof out->kernel, "%s %s", kernel.release, kernel.version);
    }
    cli_os_release_read(places->os_release, &out->system);
    cli_os_release_value(places->slot, "SLOT", out->slot, sizeof out->slot);
}

static void print_line(const char *name, const char *version, const char *without, FILE *out)
{
    fprintf(out, "%-12s%s\n", name, *version ? version : without);
}

void cli_versions_print(const struct cli_versions *versions, FILE *out)
{
    char image[160] = "";

    print_line("isotherm", ISOTHERM_VERSION, "", out);
    print_line("isothermd", versions->daemon, "does not answer", out);
    for (size_t i = 0; i < CLI_LIBRARIES; i++) {
        print_line(versions->libraries[i].name, versions->libraries[i].version, "not installed",
                   out);
    }
    print_line("kernel", versions->kernel, "not known", out);
    print_line("system", versions->system.name, "not known", out);
    if (*versions->system.image) {
        (void)snprintf(image, sizeof image, "%s %s", versions->system.image,
                       versions->system.version);
    }
    print_line("image", image, "none: this is not an image of the appliance", out);
    if (*image) {
        print_line("slot", versions->slot, "not known", out);
        print_line("update", versions->bundle, "none known", out);
    }
}

json_t *cli_versions_json(const struct cli_versions *versions)
{
    json_t *list = json_object();

    for (size_t i = 0; list && i < CLI_LIBRARIES; i++) {
        (void)json_object_set_new(list, versions->libraries[i].name,
                                  cli_report_text(versions->libraries[i].version));
    }
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "isotherm", ISOTHERM_VERSION,
                     "isothermd", cli_report_text(versions->daemon), "libraries", list, "kernel",
                     cli_report_text(versions->kernel), "system",
                     cli_report_text(versions->system.name), "image",
                     cli_report_text(versions->system.image), "image_version",
                     cli_report_text(versions->system.version), "slot",
                     cli_report_text(versions->slot), "bundle", cli_report_text(versions->bundle));
}
