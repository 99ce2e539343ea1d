#include "tests/support/devices/soft_tpm.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { NOT_FOUND = 127, ATTEMPTS = 1000, PORT_FIRST = 20000, PORTS = 10000 };

static struct sockaddr_in address_of(int port)
{
    return (struct sockaddr_in){.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)port),
                                .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
}

static bool is_free(int port)
{
    const struct sockaddr_in address = address_of(port);
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    const int result = bind(fd, (const struct sockaddr *)&address, sizeof address);
    close(fd);
    return result == 0;
}

/* The TPM has one port, and its control channel has the next port. */
static int find_ports(void)
{
    int port = PORT_FIRST + 2 * (getpid() % (PORTS / 2));
    for (int i = 0; i < ATTEMPTS && !(is_free(port) && is_free(port + 1)); i++) {
        port += 2;
    }
    return port;
}

static void pause_ms(long ms)
{
    const struct timespec time = {.tv_nsec = ms * 1000000};
    (void)nanosleep(&time, NULL);
}

/* Returns whether a program listens on this port. The function reads the list of the kernel. It
 * does not connect to the port, because the TPM accepts only one client at a time. */
static bool listens(int port)
{
    enum { LISTEN = 0x0a };
    char line[256];
    unsigned local, state;
    bool found = false;
    FILE *sockets = fopen("/proc/net/tcp", "re");
    assert_non_null(sockets);
    while (!found && fgets(line, sizeof line, sockets)) {
        found = sscanf(line, "%*u: %*x:%x %*x:%*x %x", &local, &state) == 2 &&
                local == (unsigned)port && state == LISTEN;
    }
    (void)fclose(sockets);
    return found;
}

static void run_swtpm(const struct soft_tpm *tpm)
{
    char state[128], server[64], control[64];
    (void)snprintf(state, sizeof state, "dir=%s", tpm->directory);
    (void)snprintf(server, sizeof server, "type=tcp,port=%d", tpm->port);
    (void)snprintf(control, sizeof control, "type=tcp,port=%d", tpm->port + 1);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    execlp("swtpm", "swtpm", "socket", "--tpm2", "--tpmstate", state, "--server", server, "--ctrl",
           control, "--flags", "not-need-init,startup-clear", (char *)NULL);
    _exit(NOT_FOUND);
}

/* ---- the device ---- */

enum { HEADER_BYTES = 10, MESSAGE_MAX_BYTES = 4096 };

static bool read_all(int fd, uint8_t *bytes, size_t size)
{
    for (size_t n = 0; n < size;) {
        const ssize_t got = read(fd, bytes + n, size - n);
        if (got <= 0) {
            return false;
        }
        n += (size_t)got;
    }
    return true;
}

static bool write_all(int fd, const uint8_t *bytes, size_t size)
{
    for (size_t n = 0; n < size;) {
        const ssize_t done = write(fd, bytes + n, size - n);
        if (done <= 0) {
            return false;
        }
        n += (size_t)done;
    }
    return true;
}

/* Bytes 2 to 5 of a command or a response are its size. 0: nothing could be read. */
static size_t read_message(int fd, uint8_t message[MESSAGE_MAX_BYTES])
{
    if (!read_all(fd, message, HEADER_BYTES)) {
        return 0;
    }
    const size_t size = (size_t)message[2] << 24 | (size_t)message[3] << 16 |
                        (size_t)message[4] << 8 | message[5];
    const bool whole = size >= HEADER_BYTES && size <= MESSAGE_MAX_BYTES &&
                       read_all(fd, message + HEADER_BYTES, size - HEADER_BYTES);
    return whole ? size : 0;
}

/* Passes on commands and responses until one of the ends is closed. */
static void run_bridge(const struct soft_tpm *tpm, int device)
{
    static uint8_t message[MESSAGE_MAX_BYTES];
    const struct sockaddr_in address = address_of(tpm->port);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(server, (const struct sockaddr *)&address, sizeof address)) {
        _exit(1);
    }
    for (;;) {
        size_t size = read_message(device, message);
        size = size && write_all(server, message, size) ? read_message(server, message) : 0;
        if (size == 0 || !write_all(device, message, size)) {
            _exit(0);
        }
    }
}

/* The bridge keeps a descriptor of the slave, so that the device remains when a client closes it.
 */
static void connect_device(struct soft_tpm *tpm)
{
    char name[64];
    struct termios raw;
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(master >= 0);
    assert_int_equal(grantpt(master), 0);
    assert_int_equal(unlockpt(master), 0);
    assert_int_equal(ptsname_r(master, name, sizeof name), 0);
    const int slave = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(slave >= 0);
    assert_int_equal(tcgetattr(slave, &raw), 0);
    cfmakeraw(&raw);
    assert_int_equal(tcsetattr(slave, TCSANOW, &raw), 0);
    (void)unlink(tpm->device);
    assert_int_equal(symlink(name, tpm->device), 0);
    tpm->bridge = fork();
    assert_true(tpm->bridge >= 0);
    if (tpm->bridge == 0) {
        run_bridge(tpm, master);
    }
    close(slave);
    close(master);
}

void soft_tpm_make_device(struct soft_tpm *tpm, const char *directory)
{
    (void)snprintf(tpm->device, sizeof tpm->device, "%s/tpm0", directory);
    (void)snprintf(tpm->tcti, sizeof tpm->tcti, "device:%s", tpm->device);
    connect_device(tpm);
}

/* ---- power on and off ---- */

/* False: there is no swtpm. */
static bool launch(struct soft_tpm *tpm)
{
    int status = 0;
    tpm->pid = fork();
    assert_true(tpm->pid >= 0);
    if (tpm->pid == 0) {
        run_swtpm(tpm);
    }
    for (int i = 0; i < ATTEMPTS; i++) {
        if (listens(tpm->port) && listens(tpm->port + 1)) {
            return true;
        }
        if (waitpid(tpm->pid, &status, WNOHANG) == tpm->pid) {
            tpm->pid = 0;
            if (!WIFEXITED(status) || WEXITSTATUS(status) != NOT_FOUND) {
                fail_msg("swtpm ended with status %d", status);
            }
            return false;
        }
        pause_ms(10);
    }
    fail_msg("swtpm does not listen");
    return false;
}

bool soft_tpm_start(struct soft_tpm *tpm, const char *directory)
{
    *tpm = (struct soft_tpm){.port = find_ports()};
    (void)snprintf(tpm->directory, sizeof tpm->directory, "%s/tpm", directory);
    (void)snprintf(tpm->tcti, sizeof tpm->tcti, "swtpm:host=127.0.0.1,port=%d", tpm->port);
    assert_int_equal(mkdir(tpm->directory, 0700), 0);
    if (!launch(tpm)) {
        print_message("skipped: there is no swtpm on this machine\n");
        return false;
    }
    return true;
}

void soft_tpm_off(struct soft_tpm *tpm)
{
    if (tpm->bridge > 0) {
        (void)kill(tpm->bridge, SIGKILL);
        (void)waitpid(tpm->bridge, NULL, 0);
        tpm->bridge = 0;
    }
    if (tpm->pid > 0) {
        (void)kill(tpm->pid, SIGTERM);
        (void)waitpid(tpm->pid, NULL, 0);
        tpm->pid = 0;
    }
}

void soft_tpm_on(struct soft_tpm *tpm)
{
    assert_true(launch(tpm));
    if (*tpm->device) {
        connect_device(tpm);
    }
}

void soft_tpm_replace(struct soft_tpm *tpm)
{
    char path[400];
    soft_tpm_off(tpm);
    DIR *directory = opendir(tpm->directory);
    assert_non_null(directory);
    for (const struct dirent *entry; (entry = readdir(directory));) {
        if (entry->d_name[0] != '.') {
            (void)snprintf(path, sizeof path, "%s/%s", tpm->directory, entry->d_name);
            assert_int_equal(unlink(path), 0);
        }
    }
    closedir(directory);
    soft_tpm_on(tpm);
}
