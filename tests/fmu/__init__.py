"""Tests of stickslip_fmu: the block, its face and the packer."""
