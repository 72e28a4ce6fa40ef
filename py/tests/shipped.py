"""What is known of the shipped mechanisms."""

# Moved by one joint; they have no inverse kinematics.
LINKAGES = ["bennett-double-spherical-6r", "bennett-plano-spherical-6r", "sarrus"]
