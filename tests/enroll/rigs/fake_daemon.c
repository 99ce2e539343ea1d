#include "tests/enroll/rigs/fake_daemon.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"
#include "tests/enroll/rigs/fake_status.h"
#include "tests/enroll/rigs/fake_work.h"

void fake_trace(const struct fake_service *service, const char *text)
{
    (void)!write(service->trace_fd, text, strlen(text));
}

/* Notes the call. If the script lets this method fail, answers it with the scripted error and
 * returns true. */
bool fake_fails(const struct fake_service *service, sd_bus_message *call, sd_bus_error *error)
{
    const char *method = sd_bus_message_get_member(call);
    const struct fake_script *script = service->script;

    fake_trace(service, ";");
    fake_trace(service, method);
    if (!script->fail_method || strcmp(method, script->fail_method) != 0) {
        return false;
    }
    sd_bus_error_set(error, script->fail_error,
                     script->fail_text ? script->fail_text : "the fake says so");
    return true;
}

bool fake_is_claimant(const struct fake_service *service, sd_bus_message *call, sd_bus_error *error)
{
    if (strcmp(service->claimed_by, sd_bus_message_get_sender(call)) == 0) {
        return true;
    }
    sd_bus_error_set(error, ISO_CONTRACT_ERROR_CLAIM_DEVICE, "not claimed by the caller");
    return false;
}

int fake_open_bus(const char *address, sd_bus **bus)
{
    int r = sd_bus_new(bus);

    if (r >= 0) {
        r = sd_bus_set_address(*bus, address);
    }
    if (r >= 0) {
        r = sd_bus_set_bus_client(*bus, 1);
    }
    return r < 0 ? r : sd_bus_start(*bus);
}

static int on_status(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    sd_bus_message *reply = NULL;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = fake_status_append(reply, service->script);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

/* Handles the methods that take long. Meanwhile the stand-in does nothing else. */
static int on_work(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;

    return fake_fails(service, call, error) ? -EIO : fake_work(call, service->script);
}

static int on_test_door(sd_bus_message *call, void *context, sd_bus_error *error)
{
    return fake_fails(context, call, error) ? -EIO : sd_bus_reply_method_return(call, NULL);
}

/* Notes the name, and each item with its answer. */
static int on_commission(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *by, *item, *answer, *remark;
    int r = sd_bus_message_read(call, "s", &by);

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    fake_trace(service, " ");
    fake_trace(service, r < 0 ? "?" : by);
    r = r < 0 ? r : sd_bus_message_enter_container(call, 'a', "(sss)");
    while (r >= 0 && (r = sd_bus_message_read(call, "(sss)", &item, &answer, &remark)) > 0) {
        const char *const words[] = {" ", item, "=", answer};
        for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
            fake_trace(service, words[i]);
        }
    }
    const char *outcome = service->script->commissioned;
    return r < 0 ? r
                 : sd_bus_reply_method_return(call, "st", outcome ? outcome : "passed",
                                              (uint64_t)4711);
}

static const sd_bus_vtable vtable[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("Claim", "", "", fake_on_claim, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Release", "", "", fake_on_release, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("EnrollStart", "sa{sv}", "a{sv}", fake_on_enroll_start,
                  SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("EnrollStop", "", "", fake_on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyStart", "s", "", fake_on_verify_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyStop", "", "", fake_on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("IdentifyStart", "", "", fake_on_identify_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("IdentifyStop", "", "", fake_on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ListPeople", "", "a(sxxxu)", fake_on_list, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("DeletePerson", "s", "", fake_on_delete, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetValidity", "sa{sv}", "sxx", fake_on_set_validity, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RenamePerson", "ss", "s", fake_on_rename, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetStatus", "", "a{sv}", on_status, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetSite", "", "a{sv}", fake_on_get_site, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ListLookAlikes", "", "a(ssd)", fake_on_list_look_alikes,
                  SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ListOtherSensor", "", "as", fake_on_list_other, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ResetSite", "", "u", fake_on_take_back, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RollBackSite", "", "u", fake_on_take_back, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetSettings", "", "a(ssssssbs)", fake_on_get_settings,
                  SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetSetting", "sss", "s", fake_on_set_setting, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ResetSetting", "ss", "s", fake_on_reset_setting, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetPolicy", "", "st", fake_on_get_policy, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetPolicy", "st", "tas", fake_on_set_policy, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("CheckPolicy", "", "as", fake_on_check_policy, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("TestAccess", "ssxas", "a{sv}", fake_on_test_access, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetCredential", "s", "s", fake_on_get_credential, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetCredential", "ss", "s", fake_on_set_credential, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("AimStart", "", "", fake_on_aim_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("AimStop", "", "", fake_on_aim_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Picture", "", "h", fake_on_picture, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("TestDoor", "", "", on_test_door, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RecordCommission", "sa(sss)", "st", on_commission, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ReadLog", "tu", "as", fake_on_read_log, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyLog", "ts", "bttsts", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ExportPeople", "hasa{sv}", "u", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ImportPeople", "ha{sv}", "uu", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RotateKeys", "", "s", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_VTABLE_END,
};

static int serve(struct fake_service *service, int ready_fd)
{
    sd_bus *bus = NULL;
    int r = fake_open_bus(service->address, &bus);

    if (r >= 0) {
        r = sd_bus_add_object_vtable(bus, NULL, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, vtable,
                                     service);
    }
    if (r >= 0) {
        r = sd_bus_request_name(bus, ISO_CONTRACT_NAME, 0);
    }
    if (r >= 0) {
        r = (int)write(ready_fd, "r", 1);
    }
    while (r >= 0 && !service->leave) {
        r = sd_bus_process(bus, NULL);
        r = r == 0 ? sd_bus_wait(bus, UINT64_MAX) : r;
    }
    sd_bus_flush_close_unref(bus);
    return r;
}

void fake_daemon_start(struct fake_daemon *daemon, const char *address,
                       const struct fake_script *script)
{
    int ready[2], calls[2];
    char byte;

    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(calls), 0);
    daemon->pid = fork();
    assert_true(daemon->pid >= 0);
    if (daemon->pid == 0) {
        struct fake_service service = {.script = script, .address = address, .trace_fd = calls[1]};
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ready[0]);
        close(calls[0]);
        _exit(serve(&service, ready[1]) < 0);
    }
    close(ready[1]);
    close(calls[1]);
    daemon->trace_fd = calls[0];
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
}

const char *fake_daemon_stop(struct fake_daemon *daemon)
{
    static char calls[4096];
    size_t length = 0;
    ssize_t n;

    kill(daemon->pid, SIGTERM);
    waitpid(daemon->pid, NULL, 0);
    while ((n = read(daemon->trace_fd, calls + length, sizeof calls - 1 - length)) > 0) {
        length += (size_t)n;
    }
    close(daemon->trace_fd);
    calls[length] = '\0';
    return length ? calls + 1 : calls;
}
