/* Many doors of a fleet in one process, for tests/fleet/fleet_check.sh.
 *
 *   fleet_doors run FOLDER FIRST COUNT   doors FIRST ... FIRST + COUNT - 1, in FOLDER/NUMBER each,
 *                                        until SIGTERM; commands come over FOLDER/FIRST.socket
 *   fleet_doors ask SOCKET WORD...       sends one command, and prints the answer
 *
 * Commands (NUMBER: of a door, or "all"):
 *   show NUMBER FACE          "allow NAME", "deny REASON" or "nothing", one line a door
 *   enrol NUMBER NAME FACE    "" or a fault
 *   address NUMBER            the appliance's address
 *   join NUMBER FILE          "ok" or a fault; FILE: the membership
 *   advance NUMBER SECONDS    moves the clock since the boot forward
 *   link NUMBER on|off        "ok"; stops the link, and starts it anew if it is on
 *   update NUMBER             check_door_update()
 *   state NUMBER              check_door_describe()
 */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <systemd/sd-event.h>
#include <unistd.h>

#include "firmware/fleet/message/envelope.h"
#include "tests/fleet/check_door.h"

enum { DOORS_MOST = 200, LINE_SIZE = 2000, STEP_US = 10000 };

struct program {
    sd_event *event;
    struct link_http *http;
    int first, n;
    struct check_door *doors[DOORS_MOST];
};

static void fail(const char *what)
{
    fprintf(stderr, "fleet_doors: %s: %s\n", what, strerror(errno));
    exit(4);
}

static struct sockaddr_un address_of(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        fail(path);
    }
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    return address;
}

/* ---- commands ---- */

static void answer_for(struct check_door *door, char *const words[], int n, char *answer,
                       size_t size)
{
    char text[ISO_TRANSFER_ADDRESS_SIZE] = "";
    if (strcmp(words[0], "show") == 0 && n == 3) {
        (void)snprintf(answer, size, "%s", check_door_answer(door));
    } else if (strcmp(words[0], "enrol") == 0 && n == 4) {
        check_door_enrol(door, words[2], atoi(words[3]), answer, size);
    } else if (strcmp(words[0], "address") == 0) {
        check_door_address(door, text);
        (void)snprintf(answer, size, "%s", text);
    } else if (strcmp(words[0], "join") == 0 && n == 3) {
        check_door_join(door, words[2], answer, size);
    } else if (strcmp(words[0], "advance") == 0 && n == 3) {
        check_door_advance(door, atoll(words[2]));
        (void)snprintf(answer, size, "ok");
    } else if (strcmp(words[0], "link") == 0 && n == 3) {
        check_door_link(door, strcmp(words[2], "on") == 0);
        (void)snprintf(answer, size, "ok");
    } else if (strcmp(words[0], "update") == 0) {
        check_door_update(door, answer, size);
    } else if (strcmp(words[0], "state") == 0) {
        check_door_describe(door, answer, size);
    } else {
        (void)snprintf(answer, size, "unknown command");
    }
}

static void obey(struct program *program, char *line, FILE *out)
{
    char *words[6], answer[LINE_SIZE], *rest = NULL;
    int n = 0;
    for (char *word = strtok_r(line, " \n", &rest); word && n < 6;
         word = strtok_r(NULL, " \n", &rest)) {
        words[n++] = word;
    }
    if (n < 2) {
        (void)fprintf(out, "unknown command\n");
        return;
    }
    const int only = strcmp(words[1], "all") == 0 ? -1 : atoi(words[1]) - program->first;
    if (only >= program->n) {
        (void)fprintf(out, "no such door\n");
        return;
    }
    const int begin = only < 0 ? 0 : only, end = only < 0 ? program->n : only + 1;
    if (strcmp(words[0], "show") == 0 && n == 3) {
        check_doors_show(program->doors + begin, end - begin, atoi(words[2]));
    }
    for (int i = begin; i < end; i++) {
        answer[0] = '\0';
        answer_for(program->doors[i], words, n, answer, sizeof answer);
        (void)fprintf(out, "%d %s\n", program->first + i, answer);
    }
}

static int on_client(sd_event_source *source, int fd, uint32_t events, void *context)
{
    char line[LINE_SIZE] = "";
    (void)source, (void)events;
    const int client = accept4(fd, NULL, NULL, SOCK_CLOEXEC);
    FILE *stream = client < 0 ? NULL : fdopen(client, "r+");
    if (stream) {
        if (fgets(line, sizeof line, stream)) {
            obey(context, line, stream);
        }
        (void)fclose(stream);
    }
    return 0;
}

/* ---- running ---- */

static int on_step(sd_event_source *source, uint64_t now_us, void *context)
{
    struct program *program = context;
    (void)now_us;
    for (int i = 0; i < program->n; i++) {
        check_door_step(program->doors[i]);
    }
    uint64_t next_us = 0;
    (void)sd_event_now(program->event, CLOCK_MONOTONIC, &next_us);
    (void)sd_event_source_set_time(source, next_us + STEP_US);
    return sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

static void listen_at(struct program *program, const char *path)
{
    const struct sockaddr_un address = address_of(path);
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    (void)unlink(path);
    if (fd < 0 || bind(fd, (const struct sockaddr *)&address, sizeof address) || listen(fd, 8) ||
        sd_event_add_io(program->event, NULL, fd, EPOLLIN, on_client, program) < 0) {
        fail(path);
    }
}

static int run(const char *folder, int first, int count)
{
    static struct program program;
    struct iso_fault fault = {.text = ""};
    char path[4096];
    sigset_t ends;
    if (count < 1 || count > DOORS_MOST) {
        fprintf(stderr, "fleet_doors: 1 to %d doors\n", DOORS_MOST);
        return 2;
    }
    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigemptyset(&ends);
    (void)sigaddset(&ends, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, &ends, NULL);
    program.first = first;
    if (iso_fleet_start(&fault) || sd_event_default(&program.event) < 0 ||
        sd_event_add_signal(program.event, NULL, SIGTERM, NULL, NULL) < 0 ||
        link_http_new(program.event, &program.http, &fault)) {
        fail("start");
    }
    for (program.n = 0; program.n < count; program.n++) {
        (void)snprintf(path, sizeof path, "%s/%d", folder, first + program.n);
        const struct check_door_setup setup = {
            .event = program.event, .http = program.http, .folder = path};
        program.doors[program.n] = check_door_new(&setup);
    }
    (void)snprintf(path, sizeof path, "%s/%d.socket", folder, first);
    listen_at(&program, path);
    if (sd_event_add_time(program.event, NULL, CLOCK_MONOTONIC, 0, 1000, on_step, &program) < 0) {
        fail("timer");
    }
    puts("ready");
    (void)fflush(stdout);
    const int r = sd_event_loop(program.event);
    while (program.n > 0) {
        check_door_free(program.doors[--program.n]);
    }
    link_http_free(program.http);
    sd_event_unref(program.event);
    return r < 0 ? 4 : 0;
}

static int ask(const char *path, char *const words[], int n)
{
    const struct sockaddr_un address = address_of(path);
    char line[LINE_SIZE];
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0 || connect(fd, (const struct sockaddr *)&address, sizeof address)) {
        fail(path);
    }
    FILE *stream = fdopen(fd, "r+");
    for (int i = 0; i < n; i++) {
        (void)fprintf(stream, "%s%s", i ? " " : "", words[i]);
    }
    (void)fprintf(stream, "\n");
    (void)fflush(stream);
    while (fgets(line, sizeof line, stream)) {
        (void)fputs(line, stdout);
    }
    (void)fclose(stream);
    return 0;
}

int main(int argc, char *argv[])
{
    if (argc == 5 && strcmp(argv[1], "run") == 0) {
        return run(argv[2], atoi(argv[3]), atoi(argv[4]));
    }
    if (argc >= 4 && strcmp(argv[1], "ask") == 0) {
        return ask(argv[2], argv + 3, argc - 3);
    }
    fprintf(stderr, "usage: fleet_doors run FOLDER FIRST COUNT | ask SOCKET WORD...\n");
    return 2;
}
