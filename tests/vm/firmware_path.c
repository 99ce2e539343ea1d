// SPDX-License-Identifier: MIT OR GPL-2.0
/* A module of the kernel: gives the virtual USB host (vhci_hcd.0) the attribute firmware_node/path,
 * which a hardware host gets from its firmware. libcamera uses it in the names of cameras, and
 * cannot name a camera without it. */
#include <linux/device.h>
#include <linux/kobject.h>
#include <linux/module.h>
#include <linux/platform_device.h>
#include <linux/sysfs.h>

static struct device *host;
static struct kobject *node;

static ssize_t path_show(struct kobject *kobj, struct kobj_attribute *attribute, char *text)
{
    return sysfs_emit(text, "\\VHCI\n");
}

static struct kobj_attribute path_attribute = __ATTR_RO(path);

static int __init firmware_path_init(void)
{
    int error = -ENODEV;
    host = bus_find_device_by_name(&platform_bus_type, NULL, "vhci_hcd.0");
    if (host) {
        node = kobject_create_and_add("firmware_node", &host->kobj);
        error = node ? sysfs_create_file(node, &path_attribute.attr) : -ENOMEM;
    }
    if (error) {
        kobject_put(node);
        put_device(host);
    }
    return error;
}

static void __exit firmware_path_exit(void)
{
    kobject_put(node);
    put_device(host);
}

module_init(firmware_path_init);
module_exit(firmware_path_exit);
MODULE_LICENSE("Dual MIT/GPL");
