"""The exact stick-slip block, its FMI face and the packer that makes the FMU of them."""
