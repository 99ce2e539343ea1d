#include "enroll/cli/setup/choose.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/machine/cameras.h"
#include "enroll/cli/machine/text_file.h"
#include "enroll/cli/setup/candidates.h"

static bool may_ask(const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue)
{
    return dialogue->terminal && !wish->yes;
}

/* ---- the board ---- */

static void list_boards(const struct cli_boards *boards, char *out, size_t size)
{
    size_t used = 0;

    out[0] = '\0';
    for (size_t i = 0; i < boards->n && used < size; i++) {
        const int n = snprintf(out + used, size - used, "%s%s", i ? ", " : "",
                               boards->items[i].name);
        used += n > 0 ? (size_t)n : 0;
    }
}

/* Returns the recognised board, with the number of recognised boards in *n. If none was recognised,
 * returns the board `generic`, which has no lines, or the first board. */
static size_t best_board(const struct cli_boards *boards, size_t *n)
{
    size_t best = 0;

    *n = 0;
    for (size_t i = 0; i < boards->n; i++) {
        const bool here = boards->items[i].here;
        if ((here && *n == 0) || (*n == 0 && strcmp(boards->items[i].name, "generic") == 0)) {
            best = i;
        }
        *n += here;
    }
    return best;
}

static enum cli_exit ask_board(const struct cli_boards *boards, size_t best,
                               const struct cli_dialogue *dialogue, size_t *out)
{
    static char lines[CLI_BOARDS_MAX][224];
    const char *choices[CLI_BOARDS_MAX];

    for (size_t i = 0; i < boards->n; i++) {
        const struct cli_board *board = &boards->items[i];
        (void)snprintf(lines[i], sizeof lines[i], "%-16s %s%s", board->name, board->title,
                       board->here ? " (recognised)" : "");
        choices[i] = lines[i];
    }
    fputs("Which board has the door's lines?\n", dialogue->out);
    return cli_dialogue_choose(dialogue, "Board", choices, boards->n, best, out);
}

static enum cli_exit choose_board(const struct cli_setup_places *places,
                                  const struct cli_setup_wish *wish,
                                  const struct cli_dialogue *dialogue, struct cli_board *out,
                                  struct cli_fault *fault)
{
    struct cli_boards boards;
    char names[160];
    size_t n_here, chosen;
    enum cli_exit exit = cli_boards_find(places, &boards, fault);

    if (exit) {
        return exit;
    }
    list_boards(&boards, names, sizeof names);
    if (wish->board) {
        const struct cli_board *board = cli_boards_get(&boards, wish->board);
        if (!board) {
            return cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-board",
                                 "there is no board '%.40s'; there are: %s", wish->board, names);
        }
        *out = *board;
        return CLI_EXIT_OK;
    }
    chosen = best_board(&boards, &n_here);
    if (may_ask(wish, dialogue)) {
        exit = ask_board(&boards, chosen, dialogue, &chosen);
    } else if (n_here != 1) {
        exit = cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "--board is missing, and no single board was recognised; "
                             "there are: %s",
                             names);
    }
    *out = boards.items[chosen];
    return exit;
}

static enum cli_exit read_board(const struct cli_setup_places *places,
                                struct cli_setup_choice *choice, struct cli_fault *fault)
{
    char path[PATH_MAX];

    (void)snprintf(path, sizeof path, "%s/%s/isotherm.conf", places->boards, choice->board.name);
    struct iso_fault why = {.text = ""};
    choice->board_text = cli_text_file_read(path, &why);
    return choice->board_text ? CLI_EXIT_OK
                              : cli_fault_set(fault, CLI_EXIT_FAULT, "no-file", "%s", why.text);
}

/* ---- the sensor ---- */

/* Asks for the details of an entry after the cameras: the folder of a recording if `stored`, else
 * any sensor. */
static enum cli_exit ask_other(const struct cli_dialogue *dialogue, bool stored,
                               struct cli_sensor_word *out, struct cli_fault *fault)
{
    char answer[CLI_ANSWER_SIZE], word[CLI_ANSWER_SIZE + 8];
    const enum cli_exit exit = cli_dialogue_text(
        dialogue, stored ? "Folder of the recording:" : "Sensor, such as v4l2:/dev/video0:", NULL,
        answer);

    (void)snprintf(word, sizeof word, "%s%s", stored ? "replay:" : "", answer);
    return exit ? exit : cli_sensor_word_parse(word, out, fault);
}

static enum cli_exit ask_sensor(const struct cli_candidates *candidates,
                                const struct cli_dialogue *dialogue, struct cli_sensor_word *out,
                                struct cli_fault *fault)
{
    const char *choices[CLI_CANDIDATES_MAX + 2];
    const size_t n = candidates->n;
    size_t chosen;

    for (size_t i = 0; i < n; i++) {
        choices[i] = candidates->items[i].text;
    }
    choices[n] = "stored frames (a recording), to try it without a camera";
    choices[n + 1] = "another one, which you enter";
    fputs(n ? "Which camera looks at the visitors?\n" : "No depth camera was found.\n",
          dialogue->out);
    enum cli_exit exit = cli_dialogue_choose(dialogue, "Camera", choices, n + 2, 0, &chosen);
    if (!exit && chosen < n) {
        *out = candidates->items[chosen].sensor;
    } else if (!exit) {
        exit = ask_other(dialogue, chosen == n, out, fault);
    }
    return exit;
}

static enum cli_exit no_sensor(const struct cli_candidates *candidates,
                               const struct cli_devices *devices, struct cli_fault *fault)
{
    char found[160] = "no depth camera was found";
    size_t used = 0;

    for (size_t i = 0; i < candidates->n && used < sizeof found; i++) {
        const int n = snprintf(found + used, sizeof found - used, "%s%s",
                               i ? "; " : "found: ", candidates->items[i].text);
        used += n > 0 ? (size_t)n : 0;
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--sensor is missing: %s%s%.60s", found,
                         devices->fault[0] ? "; " : "", devices->fault);
}

static enum cli_exit choose_sensor(const struct cli_setup_places *places,
                                   const struct cli_setup_wish *wish,
                                   const struct cli_dialogue *dialogue,
                                   struct cli_setup_choice *choice, struct cli_fault *fault)
{
    static struct cli_devices devices;
    static struct cli_candidates candidates;

    if (wish->sensor) {
        return cli_sensor_word_parse(wish->sensor, &choice->sensor, fault);
    }
    if (may_ask(wish, dialogue)) {
        fputs("Looking for cameras ...\n", dialogue->out);
        (void)fflush(dialogue->out);
    }
    const enum cli_exit exit = cli_devices_find(places, &devices, fault);
    if (exit) {
        return exit;
    }
    cli_candidates_find(places, &devices, choice->board_text, &candidates);
    if (may_ask(wish, dialogue)) {
        return ask_sensor(&candidates, dialogue, &choice->sensor, fault);
    }
    if (candidates.n != 1) {
        return no_sensor(&candidates, &devices, fault);
    }
    choice->sensor = candidates.items[0].sensor;
    return CLI_EXIT_OK;
}

/* ---- the file that describes a depth camera with a kernel driver ---- */

static enum cli_exit ask_camera(const struct cli_cameras *cameras,
                                const struct cli_dialogue *dialogue, char out[CLI_ANSWER_SIZE])
{
    const char *choices[CLI_CAMERAS_MAX + 1];
    size_t chosen;

    for (size_t i = 0; i < cameras->n; i++) {
        choices[i] = cameras->paths[i];
    }
    choices[cameras->n] = "another file, which you enter";
    fputs("Which file describes the lens of this camera?\n", dialogue->out);
    const enum cli_exit exit = cli_dialogue_choose(dialogue, "File", choices, cameras->n + 1, 0,
                                                   &chosen);
    if (!exit && chosen == cameras->n) {
        return cli_dialogue_text(dialogue, "File:", NULL, out);
    }
    if (!exit) {
        (void)snprintf(out, CLI_ANSWER_SIZE, "%s", cameras->paths[chosen]);
    }
    return exit;
}

static enum cli_exit choose_camera(const struct cli_setup_places *places,
                                   const struct cli_setup_wish *wish,
                                   const struct cli_dialogue *dialogue,
                                   struct cli_sensor_word *sensor, struct cli_fault *fault)
{
    static struct cli_cameras cameras;
    const char *node = cli_sensor_word_get(sensor, "device");
    char usb_id[16] = "", answer[CLI_ANSWER_SIZE];

    if (strcmp(sensor->backend, "v4l2") != 0 || !node || cli_sensor_word_get(sensor, "camera")) {
        return CLI_EXIT_OK;
    }
    cli_cameras_list(places, &cameras);
    cli_device_usb_id(places, node, usb_id);
    const char *path = cli_cameras_find(&cameras, usb_id);
    if (path) {
        return cli_sensor_word_set(sensor, "camera", path, fault);
    }
    if (!may_ask(wish, dialogue)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "%s has no description in %s; name one: --sensor "
                             "v4l2:DEVICE,camera=FILE (see isotherm.conf(5))",
                             *usb_id ? usb_id : node, places->cameras);
    }
    const enum cli_exit exit = ask_camera(&cameras, dialogue, answer);
    return exit ? exit : cli_sensor_word_set(sensor, "camera", answer, fault);
}

enum cli_exit cli_setup_choose(const struct cli_setup_places *places,
                               const struct cli_setup_wish *wish,
                               const struct cli_dialogue *dialogue, struct cli_setup_choice *out,
                               struct cli_fault *fault)
{
    struct cli_setup_choice choice = {.board_text = NULL};
    enum cli_exit exit = choose_board(places, wish, dialogue, &choice.board, fault);

    if (!exit) {
        exit = read_board(places, &choice, fault);
    }
    if (!exit) {
        exit = choose_sensor(places, wish, dialogue, &choice, fault);
    }
    if (!exit) {
        exit = choose_camera(places, wish, dialogue, &choice.sensor, fault);
    }
    if (exit) {
        free(choice.board_text);
        return exit;
    }
    *out = choice;
    return CLI_EXIT_OK;
}
