#include "tests/support/programs/private_bus.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/child_end.h"

enum { NOT_FOUND = 127 };

static const char configuration[] =
    "<!DOCTYPE busconfig PUBLIC \"-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN\"\n"
    " \"http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd\">\n"
    "<busconfig><type>session</type><listen>unix:path=%s/bus</listen><auth>EXTERNAL</auth>\n"
    "<policy context=\"default\"><allow send_destination=\"*\" eavesdrop=\"true\"/>\n"
    "<allow eavesdrop=\"true\"/><allow own=\"*\"/><allow user=\"*\"/></policy></busconfig>\n";

static void write_configuration(const char *directory, const char *path)
{
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    assert_true(fprintf(file, configuration, directory) > 0);
    assert_int_equal(fclose(file), 0);
}

void private_bus_include(const struct private_bus *bus, const char *file)
{
    char path[96];

    (void)snprintf(path, sizeof path, "%s/bus.conf", bus->directory);
    FILE *file_of_bus = fopen(path, "r+");
    assert_non_null(file_of_bus);
    assert_int_equal(fseek(file_of_bus, -(long)strlen("</busconfig>\n"), SEEK_END), 0);
    assert_true(fprintf(file_of_bus, "<include>%s</include></busconfig>\n", file) > 0);
    assert_int_equal(fclose(file_of_bus), 0);
}

static void write_in_directory(const struct private_bus *bus)
{
    char path[96];

    (void)snprintf(path, sizeof path, "%s/bus.conf", bus->directory);
    write_configuration(bus->directory, path);
}

bool private_bus_start(struct private_bus *bus)
{
    strcpy(bus->directory, "/tmp/isotherm-bus-XXXXXX");
    assert_non_null(mkdtemp(bus->directory));
    write_in_directory(bus);
    return private_bus_revive(bus);
}

bool private_bus_revive(struct private_bus *bus)
{
    char option[128];
    int address[2];
    size_t length = 0;
    ssize_t n;

    (void)snprintf(option, sizeof option, "--config-file=%s/bus.conf", bus->directory);
    assert_int_equal(pipe(address), 0);
    bus->pid = fork();
    assert_true(bus->pid >= 0);
    if (bus->pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        dup2(address[1], STDOUT_FILENO);
        close(address[0]);
        close(address[1]);
        execlp("dbus-daemon", "dbus-daemon", option, "--nofork", "--nopidfile", "--print-address=1",
               (char *)NULL);
        _exit(NOT_FOUND);
    }
    close(address[1]);
    do { /* the bus listens when it has printed the line with its address */
        n = read(address[0], bus->address + length, sizeof bus->address - 1 - length);
        length += n > 0 ? (size_t)n : 0;
        bus->address[length] = '\0';
    } while (n > 0 && !strchr(bus->address, '\n'));
    close(address[0]);
    bus->address[strcspn(bus->address, ",\n")] = '\0'; /* without the guid, which changes */
    if (bus->address[0] == '\0') {
        int status = 0;
        waitpid(bus->pid, &status, 0);
        bus->pid = 0;
        private_bus_stop(bus);
        child_expect_code("dbus-daemon", child_code(status), NOT_FOUND, NULL, NULL);
        print_message("skipped: there is no dbus-daemon on this machine\n");
        return false;
    }
    return true;
}

static void remove_file(const struct private_bus *bus, const char *name)
{
    char path[96];

    (void)snprintf(path, sizeof path, "%s/%s", bus->directory, name);
    unlink(path);
}

void private_bus_kill(struct private_bus *bus)
{
    if (bus->pid > 0) {
        kill(bus->pid, SIGTERM);
        waitpid(bus->pid, NULL, 0);
        bus->pid = 0;
    }
    remove_file(bus, "bus");
}

void private_bus_stop(struct private_bus *bus)
{
    private_bus_kill(bus);
    remove_file(bus, "bus.conf");
    rmdir(bus->directory);
}
