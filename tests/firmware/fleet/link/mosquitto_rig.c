#include "tests/firmware/fleet/link/mosquitto_rig.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

static const char program[] = "/usr/sbin/mosquitto";

bool mosquitto_rig_is_there(void)
{
    if (access(program, X_OK) == 0) {
        return true;
    }
    print_message("skipped: there is no mosquitto on this machine\n");
    return false;
}

static struct sockaddr_in local(uint16_t port)
{
    return (struct sockaddr_in){
        .sin_family = AF_INET, .sin_port = htons(port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
}

uint16_t mosquitto_rig_free_port(void)
{
    struct sockaddr_in address = local(0);
    socklen_t size = sizeof address;
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
    assert_int_equal(close(fd), 0);
    return ntohs(address.sin_port);
}

static bool listens(uint16_t port)
{
    const struct sockaddr_in address = local(port);
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    const bool result = connect(fd, (const struct sockaddr *)&address, sizeof address) == 0;
    (void)close(fd);
    return result;
}

void mosquitto_rig_revive(struct mosquitto_rig *rig)
{
    char configuration[256], log[256];

    assert_int_equal(rig->pid, 0);
    (void)snprintf(configuration, sizeof configuration, "%s/mosquitto.conf", rig->directory);
    (void)snprintf(log, sizeof log, "%s/mosquitto.log", rig->directory);
    rig->pid = fork();
    assert_true(rig->pid >= 0);
    if (rig->pid == 0) {
        const int fd = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        (void)dup2(fd, STDOUT_FILENO);
        (void)dup2(fd, STDERR_FILENO);
        closefrom(STDERR_FILENO + 1); /* as in update_program.c */
        (void)execl(program, program, "-c", configuration, (char *)NULL);
        _exit(127);
    }
    for (int i = 0; i < 500 && !listens(rig->port); i++) {
        int status = 0;
        assert_int_equal(waitpid(rig->pid, &status, WNOHANG), 0);
        (void)usleep(20000);
    }
    assert_true(listens(rig->port));
}

void mosquitto_rig_start(struct mosquitto_rig *rig, const char *directory, bool tls)
{
    char text[2048], files[1024] = "";

    (void)snprintf(rig->directory, sizeof rig->directory, "%s", directory);
    rig->pid = 0;
    rig->port = mosquitto_rig_free_port();
    if (tls) {
        (void)snprintf(files, sizeof files,
                       "cafile %s/ca.pem\ncertfile %s/server.pem\nkeyfile %s/server-key.pem\n"
                       "require_certificate true\nuse_identity_as_username true\n",
                       directory, directory, directory);
    }
    (void)snprintf(text, sizeof text,
                   "persistence false\nset_tcp_nodelay true\nlog_dest stderr\n%s"
                   "listener %u 127.0.0.1\n%sallow_anonymous %s\n",
                   geteuid() == 0 ? "user root\n" : "", rig->port, files, tls ? "false" : "true");
    scratch_write_text(scratch_path(directory, "mosquitto.conf"), text);
    mosquitto_rig_revive(rig);
}

void mosquitto_rig_kill(struct mosquitto_rig *rig)
{
    if (rig->pid > 0) {
        (void)kill(rig->pid, SIGKILL);
        (void)waitpid(rig->pid, NULL, 0);
    }
    rig->pid = 0;
}
