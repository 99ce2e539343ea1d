#include "enroll/cli/doctor/diagnosis.h"

#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"
#include "enroll/cli/client/state.h"

static const char *const check_names[] = {
    [CLI_CHECK_GOOD] = "ok",
    [CLI_CHECK_ODD] = "warning",
    [CLI_CHECK_DENIED] = "denied",
    [CLI_CHECK_BAD] = "fault",
};

void cli_diagnosis_add(struct cli_diagnosis *diagnosis, const char *subject, enum cli_check check,
                       const char *found, const char *remedy)
{
    if (diagnosis->n_findings == CLI_FINDINGS_MAX) {
        return;
    }
    struct cli_finding *finding = &diagnosis->findings[diagnosis->n_findings++];
    finding->subject = subject;
    finding->check = check;
    (void)snprintf(finding->found, sizeof finding->found, "%s", found);
    finding->remedy = remedy;
}

static void judge_version(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *version = cli_state_text(state, "version");
    const bool same = version && strcmp(version, ISOTHERM_VERSION) == 0;

    cli_diagnosis_add(diagnosis, "version", same ? CLI_CHECK_GOOD : CLI_CHECK_ODD,
                      version ? version : "not told",
                      same ? NULL
                           : "daemon and client differ (this client: " ISOTHERM_VERSION
                             "); install both from one release and restart isothermd");
}

/* What to do about a fault is in what the daemon says of it: the first words that occur decide. */
struct remedy {
    const char *words, *remedy;
};

static const char *find_remedy(const struct remedy *remedies, size_t n, const char *fault,
                               const char *otherwise)
{
    for (size_t i = 0; i < n; i++) {
        if (strstr(fault, remedies[i].words)) {
            return remedies[i].remedy;
        }
    }
    return otherwise;
}

static const char *remedy_for_sensor(const char *fault)
{
    static const struct remedy remedies[] = {
        {"Permission denied", "install the board's udev rule; the daemon's user has to be in the "
                              "group of the device: video for /dev/video*"},
        {"option 'calibration'", "calibrate the cameras: isotherm-sim calibrate, and name its file "
                                 "in [sensor] of isotherm.conf(5)"},
        {"rms", "calibrate the cameras anew: isotherm-sim calibrate"},
        {"No such file", "name a file that is there in [sensor] of isotherm.conf(5)"},
        {"option '", "mend [sensor] in isotherm.conf(5)"},
        {"no sensor '",
         "that driver is not in this build: mend [sensor], or build with its library"},
        {"busy", "end the other program that has the camera: fuser -v /dev/video*"},
        {"in use", "end the other program that has the camera"},
        {"none of the pixel formats", "this node gives no such pictures: v4l2-ctl --list-formats; "
                                      "a camera has several nodes"},
        {"is no camera", "name a node that takes pictures: v4l2-ctl --list-devices"},
        {"gives ", "its calibration or camera file is for another size: calibrate, or mend it"},
        {"No space left", "the USB bus is full: put the cameras on two buses, or lower fps"},
        {"repeat earlier ones",
         "the camera is stuck, or is fed with stored pictures: look at it and "
         "at its cable, then unplug it and plug it in again"},
        {"no frame for", "it is silent: its cable, power and USB port; the daemon keeps trying"},
        {"gone", "its cable and power; the daemon keeps trying"},
        {"No such device", "is it plugged in? its name in [sensor] of isotherm.conf(5)"},
        {"no camera '", "name one that there is in [sensor] of isotherm.conf(5); cam --list"},
    };
    return find_remedy(remedies, sizeof remedies / sizeof *remedies, fault,
                       "check its cable and power, and [sensor] in isotherm.conf(5); the daemon "
                       "keeps trying");
}

/* It runs; its driver may know why it gives nothing all the same. A daemon that does not know of
 * that tells nothing. */
static void judge_running_sensor(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *health = cli_state_text(state, "sensor-health");
    const bool well = !health || !*health;
    const bool never = cli_state_number(state, "frames", 0) == 0;
    char found[256];

    (void)snprintf(found, sizeof found, "started%s%s%s", well ? "" : ": ", well ? "" : health,
                   !well && never ? ", and there never was a frame" : "");
    cli_diagnosis_add(diagnosis, "sensor", well ? CLI_CHECK_GOOD : CLI_CHECK_ODD, found,
                      well ? NULL
                      : strstr(health, "no recording at its path")
                          ? "let [sensor] path in isotherm.conf(5) name a recording, or choose the "
                            "driver of a camera"
                          : "check its cable and power; isotherm log");
}

static void judge_sensor(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *word = cli_state_text(state, "sensor-state");
    const char *cause = cli_state_text(state, "sensor-fault");
    char found[256];

    if (word && strcmp(word, "started") == 0) {
        judge_running_sensor(diagnosis, state);
        return;
    }
    (void)snprintf(found, sizeof found, "%s%s%s", word ? word : "not told",
                   cause && *cause ? ": " : "", cause ? cause : "");
    cli_diagnosis_add(diagnosis, "sensor", CLI_CHECK_BAD, found,
                      remedy_for_sensor(cause ? cause : ""));
}

/* What the daemon's driver sees, if it can tell. */
static void judge_devices(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *devices = cli_state_text(state, "sensor-devices");

    if (devices && strstr(devices, "cannot be opened")) {
        cli_diagnosis_add(diagnosis, "devices", CLI_CHECK_ODD, devices, remedy_for_sensor(devices));
    } else if (devices && *devices) {
        cli_diagnosis_add(diagnosis, "devices", CLI_CHECK_GOOD, devices, NULL);
    }
}

/* Pictures that are worse than half a pixel off their model are matched wrongly. */
static void judge_calibration(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *calibration = cli_state_text(state, "sensor-calibration");
    const char *pixels = calibration ? strstr(calibration, " px rms") : NULL;

    if (!calibration || !*calibration) {
        return;
    }
    while (pixels && pixels > calibration && pixels[-1] != ' ') {
        pixels--;
    }
    const bool bad = pixels && strtod(pixels, NULL) > 0.5;
    const bool unknown = strstr(calibration, "by hand") != NULL ||
                         strncmp(calibration, "nominal", strlen("nominal")) == 0;
    cli_diagnosis_add(
        diagnosis, "calibration", bad || unknown ? CLI_CHECK_ODD : CLI_CHECK_GOOD, calibration,
        bad || unknown ? "calibrate the cameras with a checkerboard: isotherm-sim calibrate"
                       : NULL);
}

/* A door that refuses everybody is not in service. */
static void judge_service(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const json_int_t left_ms = cli_state_number(state, "lockout-ms", 0);
    char found[96];

    if (json_is_true(json_object_get(state, "lockdown"))) {
        cli_diagnosis_add(diagnosis, "service", CLI_CHECK_BAD, "lockdown: nobody is let in",
                          "isotherm log says since when; end it with: isotherm lockdown off");
    } else if (left_ms > 0) {
        (void)snprintf(found, sizeof found,
                       "locked out: nobody is let in for %" JSON_INTEGER_FORMAT " s more",
                       (left_ms + 999) / 1000);
        cli_diagnosis_add(diagnosis, "service", CLI_CHECK_BAD, found,
                          "isotherm log says after which visits; end it with: isotherm lockout "
                          "clear");
    }
}

/* The door goes on, but not for everybody. */
static void judge_clock(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *fault = cli_state_text(state, "clock-fault");

    if (fault && *fault) {
        cli_diagnosis_add(
            diagnosis, "clock", CLI_CHECK_BAD, fault,
            "set the clock: timedatectl; if it is right, and an earlier date was not: "
            "isotherm lockout clear");
    }
}

/* Nothing is said while grants have enough time. */
static void judge_time(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *fault = cli_state_text(state, "stale-fault");

    if (fault && *fault) {
        cli_diagnosis_add(diagnosis, "time", CLI_CHECK_ODD, fault,
                          "choose a faster mode of the camera, relieve the machine, or raise "
                          "[sensor] stale_ms in isotherm.conf(5)");
    }
}

static void judge_door(struct cli_diagnosis *diagnosis, const json_t *state)
{
    static const struct {
        const char *word;
        enum cli_check check;
        const char *remedy;
    } states[] = {
        {"locked", CLI_CHECK_GOOD, NULL},
        {"unlocked", CLI_CHECK_GOOD, NULL},
        {"opened", CLI_CHECK_GOOD, NULL},
        {"held-open", CLI_CHECK_ODD, "the door stands open too long: close it"},
        {"forced", CLI_CHECK_BAD, "the door was opened while locked: look at it, and isotherm log"},
    };
    const char *word = cli_state_text(state, "door-state");

    for (size_t i = 0; word && i < sizeof states / sizeof *states; i++) {
        if (strcmp(word, states[i].word) == 0) {
            cli_diagnosis_add(diagnosis, "door", states[i].check, word, states[i].remedy);
            return;
        }
    }
    cli_diagnosis_add(diagnosis, "door", CLI_CHECK_BAD, word ? word : "not told",
                      "a fault of its lines or of the sensor, see there; isotherm log");
}

static const char *remedy_for_lines(const char *fault)
{
    static const struct remedy remedies[] = {
        {"no such GPIO chip", "is the board plugged in, its driver loaded? gpiodetect lists chips, "
                              "isotherm.conf(5) says how lines are named"},
        {"has such a line",
         "is its chip plugged in? gpioinfo lists the names; a line without one is CHIP:OFFSET"},
        {"has no such line", "gpioinfo lists the lines of each chip"},
        {"in use by", "end the other program, or free the line in the board's device tree"},
        {"may be opened", "install the board's udev rule; the daemon's user has to be in the group "
                          "of /dev/gpiochip*"},
        {"Permission denied", "install the board's udev rule; the daemon's user has to be in the "
                              "group of /dev/gpiochip*"},
        {"No such device", "the GPIO chip is gone: its cable and power; the daemon keeps trying"},
    };
    return find_remedy(remedies, sizeof remedies / sizeof *remedies, fault,
                       "check its wiring, and [door] in isotherm.conf(5)");
}

static void judge_lines(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *back_end = cli_state_text(state, "door");
    const char *fault = cli_state_text(state, "door-fault");
    const char *lines = cli_state_text(state, "door-lines");
    char found[256];

    if (!back_end || !fault) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_BAD, "not told",
                          "see the daemon's log: journalctl --unit=isothermd");
    } else if (*fault) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_BAD, fault, remedy_for_lines(fault));
    } else if (strcmp(back_end, "null") == 0) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_ODD, "null: nothing is switched",
                          "set [door] backend and its lines in isotherm.conf(5)");
    } else {
        (void)snprintf(found, sizeof found, "%s%s%s", back_end, lines && *lines ? ": " : "",
                       lines ? lines : "");
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_GOOD, found, NULL);
    }
}

/* A daemon that does not know of it tells nothing, and nothing is said if all is well. */
static void judge_priority(struct cli_diagnosis *diagnosis, const json_t *state)
{
    if (json_is_false(json_object_get(state, "door-realtime"))) {
        cli_diagnosis_add(diagnosis, "door thread", CLI_CHECK_ODD,
                          "no real-time priority: the door may be late on a busy machine",
                          "start the daemon by its unit, whose LimitRTPRIO=, RestrictRealtime= and "
                          "SystemCallFilter= permit it; see REAL TIME in isothermd(8)");
    }
}

static void judge_model(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *model = cli_state_text(state, "model");
    const bool there = model && *model;

    cli_diagnosis_add(diagnosis, "model", there ? CLI_CHECK_GOOD : CLI_CHECK_BAD,
                      there ? model : "not loaded",
                      there ? NULL : "reinstall head.model, or mend [model] in isotherm.conf(5)");
}

/* Nothing is said of a disk that works. */
static void judge_disk(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *fault = cli_state_text(state, "storage-fault");

    if (fault && *fault) {
        cli_diagnosis_add(diagnosis, "disk", CLI_CHECK_BAD, fault,
                          strstr(fault, "No space left")
                              ? "make room on the disk: df shows which one is full"
                              : "look what the kernel says of the disk: journalctl --dmesg");
    }
}

/* Nothing is said of a counter that works, or of none. */
static void judge_counter(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *fault = cli_state_text(state, "counter-fault");

    if (fault && *fault) {
        cli_diagnosis_add(diagnosis, "counter", CLI_CHECK_BAD, fault,
                          strstr(fault, "has no counter")
                              ? "somebody has deleted it from the TPM: look who, then stop the "
                                "daemon and run isothermd --accept-state"
                              : "is the TPM there, and may the daemon's user open it (group tss)? "
                                "[seal] in isotherm.conf(5); journalctl --dmesg");
    }
}

static void judge_gallery(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const json_int_t people = cli_state_number(state, "people", -1);
    const json_int_t templates = cli_state_number(state, "templates-usable", -1);
    const json_int_t valid = cli_state_number(state, "people-valid", people);
    char found[128];

    if (people < 0) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_BAD, "not told",
                          "see the daemon's log: journalctl --unit=isothermd");
        return;
    }
    (void)snprintf(found, sizeof found,
                   "%" JSON_INTEGER_FORMAT " %s, %" JSON_INTEGER_FORMAT " usable %s", people,
                   iso_plural((uint64_t)people, "person", "people"), templates,
                   iso_plural((uint64_t)templates, "template", "templates"));
    if (people == 0) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_ODD, found,
                          "the door opens to nobody yet: isotherm enroll NAME");
    } else if (valid == 0) {
        (void)snprintf(found, sizeof found,
                       "%" JSON_INTEGER_FORMAT " people, none of whom may come in at this time",
                       people);
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_BAD, found,
                          "isotherm list shows from when and until when each may come in; "
                          "isotherm validity NAME changes it; is the clock right?");
    } else if (templates < people) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_ODD, found,
                          "some people have no template of this algorithm: enrol them again");
    } else {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_GOOD, found, NULL);
    }
}

/* A daemon that does not know of it tells nothing. */
static void judge_image_check(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *word = cli_state_text(state, "image-check");
    const bool absent = word && strcmp(word, "absent") == 0;

    if (word) {
        cli_diagnosis_add(diagnosis, "image check", absent ? CLI_CHECK_ODD : CLI_CHECK_GOOD, word,
                          absent ? "install the package isotherm-vision, or set intensity = off in "
                                   "[recognition] of isotherm.conf(5)"
                                 : NULL);
    }
}

void cli_diagnosis_judge(struct cli_diagnosis *diagnosis, const json_t *state)
{
    judge_version(diagnosis, state);
    judge_sensor(diagnosis, state);
    judge_devices(diagnosis, state);
    judge_calibration(diagnosis, state);
    judge_service(diagnosis, state);
    judge_clock(diagnosis, state);
    judge_time(diagnosis, state);
    judge_door(diagnosis, state);
    judge_lines(diagnosis, state);
    judge_priority(diagnosis, state);
    judge_model(diagnosis, state);
    judge_image_check(diagnosis, state);
    judge_disk(diagnosis, state);
    judge_counter(diagnosis, state);
    judge_gallery(diagnosis, state);
}

enum cli_exit cli_diagnosis_exit(const struct cli_diagnosis *diagnosis)
{
    enum cli_check worst = CLI_CHECK_GOOD;

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const enum cli_check check = diagnosis->findings[i].check;
        worst = check > worst ? check : worst;
    }
    return worst == CLI_CHECK_BAD      ? CLI_EXIT_FAULT
           : worst == CLI_CHECK_DENIED ? CLI_EXIT_NO
                                       : CLI_EXIT_OK;
}

void cli_diagnosis_print(const struct cli_diagnosis *diagnosis, FILE *out)
{
    static const enum iso_paint paints[] = {
        [CLI_CHECK_GOOD] = ISO_PAINT_GOOD,
        [CLI_CHECK_ODD] = ISO_PAINT_WARNING,
        [CLI_CHECK_DENIED] = ISO_PAINT_BAD,
        [CLI_CHECK_BAD] = ISO_PAINT_BAD,
    };
    const struct iso_terminal terminal = iso_terminal_of(out);

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const struct cli_finding *finding = &diagnosis->findings[i];
        fprintf(out, "%s%-8s%s %-11s %s\n", iso_terminal_paint(&terminal, paints[finding->check]),
                check_names[finding->check], iso_terminal_paint(&terminal, ISO_PAINT_PLAIN),
                finding->subject, finding->found);
        if (finding->remedy) {
            fprintf(out, "%-8s %-11s -> %s\n", "", "", finding->remedy);
        }
    }
}

json_t *cli_diagnosis_json(const struct cli_diagnosis *diagnosis)
{
    json_t *checks = json_array();

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const struct cli_finding *finding = &diagnosis->findings[i];
        json_t *check = json_pack("{s:s, s:s, s:s, s:s?}", "subject", finding->subject, "state",
                                  check_names[finding->check], "found", finding->found, "remedy",
                                  finding->remedy);
        if (json_array_append_new(checks, check) < 0) {
            json_decref(checks);
            return NULL;
        }
    }
    return json_pack("{s:b, s:o}", "healthy", cli_diagnosis_exit(diagnosis) == CLI_EXIT_OK,
                     "checks", checks);
}
